#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/kalman/delayed_fusion_buffer.hpp>

#include <algorithm>

namespace sonopose::estimation::kalman {

using aiding::admission::future_tolerance_s;

namespace {

constexpr double longest_silence_s = 10.0;       // silence of the IMU over which fixes and headings are kept
constexpr std::size_t usual_imu_capacity = 256;  // enough for a second and a half at 170 Hz

}  // namespace

DelayedFusionBuffer::DelayedFusionBuffer() {
  now_.bank.reserve();
  imu_.reserve(imu_capacity);
  imu_.resize(usual_imu_capacity);
  aiding_.reserve(aiding_capacity);
}

void DelayedFusionBuffer::clear() {
  now_ = State{};
  time_ns_ = 0;
  next_imu_ = first_imu_ = end_imu_ = 0;
  next_aiding_ = 0;
  aiding_.clear();
  checkpoints_.clear();
  stamps_are_ahead_ = has_pending_work_ = false;
}

void DelayedFusionBuffer::start_from(const aiding::KnownSensors& known) {
  if (!checkpoints_.empty()) return;
  now_.known.push(known);
  now_.noise.start_from(known.fix_std_m);
}

bool DelayedFusionBuffer::add(const settings::Settings& settings, const ImuMeasurement& imu) {
  if (end_imu_ - first_imu_ == imu_capacity) {
    replay(settings, nullptr);
    drop_oldest_checkpoint();
  }
  make_place_for_imu();
  const bool precedes_aiding = next_aiding_ > 0 && imu.time_ns <= order_key(aiding_[next_aiding_ - 1]);
  if (precedes_aiding) rewind(imu.time_ns);
  drop_future(imu.time_ns);
  const bool comes_last = !precedes_aiding && next_aiding_ == aiding_.size();
  if (!comes_last) replay(settings, nullptr, imu.time_ns - 1);
  imu_at(end_imu_) = imu;
  ++end_imu_;
  time_ns_ = imu.time_ns;
  until_ns_ = imu.time_ns + to_ns(settings.outage.imu_gap_s);
  has_pending_work_ = true;
  if (checkpoints_.empty())
    finish_pending_work(settings);  // creates the first checkpoint, which insertions need
  return comes_last && has_pending_work_;
}

void DelayedFusionBuffer::finish_pending_work(const settings::Settings& settings) {
  if (!has_pending_work_) return;
  replay(settings, nullptr, until_ns_);
  has_pending_work_ = false;
}

void DelayedFusionBuffer::on_mount_offset_change(double by_rad) {
  if (checkpoints_.empty()) return;
  now_.on_mount_offset_change(by_rad);
  restart();
}

/// Removes measurements long after this sample. The IMU was not silent, so their stamps are wrong.
void DelayedFusionBuffer::drop_future(TimeNs now_ns) {
  dropped_ = {};
  while (!aiding_.empty() && order_key(aiding_.back()) - now_ns > to_ns(future_tolerance_s)) {
    if (std::holds_alternative<HeadingMeasurement>(aiding_.back())) ++dropped_.headings;
    if (std::holds_alternative<TwistMeasurement>(aiding_.back())) ++dropped_.twists;
    aiding_.pop_back();
    stamps_are_ahead_ = true;
  }
}

double DelayedFusionBuffer::max_ahead_s() const {
  return stamps_are_ahead_ ? future_tolerance_s : longest_silence_s;
}

bool DelayedFusionBuffer::can_insert(TimeNs time_ns) const {
  return !checkpoints_.empty() && checkpoints_.oldest().state.imu.time_ns <= time_ns &&
         aiding_.size() < aiding_capacity;
}

bool DelayedFusionBuffer::contains(const AidingMeasurement& aiding) const {
  return std::any_of(aiding_.begin(), aiding_.end(),
                     [&](const AidingMeasurement& other) { return is_copy(other, aiding); });
}

FixOutcome DelayedFusionBuffer::add(const settings::Settings& settings, const AidingMeasurement& aiding) {
  stamps_are_ahead_ = false;
  const std::size_t index = insert(aiding);
  const bool is_ahead = index >= next_aiding_ && order_key(aiding) >= now_.imu.time_ns;
  if (!is_ahead) rewind(order_key(aiding));
  until_ns_ = forever_ns;
  has_pending_work_ = true;
  return replay(settings, &aiding_[index]);
}

/// Doubles a full ring: each number keeps its place or gets one in the new half.
void DelayedFusionBuffer::make_place_for_imu() {
  const std::uint64_t before = imu_.size();
  if (end_imu_ - first_imu_ < before) return;
  imu_.resize(2 * before);  // reallocates in a copy, which has no reserve
  for (std::uint64_t i = first_imu_; i < end_imu_; ++i) imu_at(i) = imu_[i % before];
}

/// Inserts it in order; fixes come before headings of equal time, in whatever order they arrive.
std::size_t DelayedFusionBuffer::insert(const AidingMeasurement& aiding) {
  const TimeNs turn_ns = order_key(aiding);
  const auto place = std::find_if(aiding_.begin(), aiding_.end(), [&](const AidingMeasurement& other) {
    return turn_ns < order_key(other) || (order_key(other) == turn_ns && aiding.index() < other.index());
  });
  const auto inserted = aiding_.insert(place, aiding);  // reallocates in a copy, which has no reserve
  return static_cast<std::size_t>(inserted - aiding_.begin());
}

/// Returns to the last checkpoint that is not after this time.
void DelayedFusionBuffer::rewind(TimeNs time_ns) {
  const Checkpoint& from = checkpoints_.rewind(time_ns);
  now_ = from.state;
  next_imu_ = from.next_imu;
  next_aiding_ = static_cast<std::size_t>(std::find_if(aiding_.begin(), aiding_.end(),
                                                       [&](const AidingMeasurement& aiding) {
                                                         return order_key(aiding) >= from.state.imu.time_ns;
                                                       }) -
                                          aiding_.begin());
}

void DelayedFusionBuffer::replay_imu(const settings::Settings& settings, const ImuMeasurement& imu) {
  now_.on_imu(settings, imu);
  ++next_imu_;
  if (checkpoints_.is_due(imu.time_ns)) save_checkpoint();
}

/// Folds the events in order, up to `last`, whose outcome it returns, or all until a time.
FixOutcome DelayedFusionBuffer::replay(const settings::Settings& settings, const AidingMeasurement* last,
                                       TimeNs until_ns) {
  while (next_imu_ < end_imu_ || next_aiding_ < aiding_.size()) {
    if (next_imu_ < end_imu_) {
      const ImuMeasurement& imu = imu_at(next_imu_);
      if (next_aiding_ == aiding_.size() || imu.time_ns <= order_key(aiding_[next_aiding_])) {
        replay_imu(settings, imu);
        continue;
      }
    }
    if (order_key(aiding_[next_aiding_]) > until_ns) break;
    const AidingMeasurement& aiding = aiding_[next_aiding_++];
    FixOutcome outcome;
    if (const auto* fix = std::get_if<FixMeasurement>(&aiding)) {
      outcome = now_.on_fix(settings, *fix);
    } else if (const auto* twist = std::get_if<TwistMeasurement>(&aiding)) {
      now_.on_twist(settings, *twist);
    } else {
      now_.on_heading(settings, *std::get_if<HeadingMeasurement>(&aiding));
    }
    if (&aiding == last) return outcome;
  }
  return {};
}

void DelayedFusionBuffer::save_checkpoint() {
  now_.apply_pending_steps();
  if (now_.covariance_is_old()) now_.propagate();
  checkpoints_.add(now_, next_imu_);
  forget_before_oldest();
}

/// Restarts from the current state: nothing can be inserted before it.
void DelayedFusionBuffer::restart() {
  checkpoints_.clear();
  aiding_.clear();
  next_aiding_ = 0;
  save_checkpoint();
}

void DelayedFusionBuffer::drop_oldest_checkpoint() {
  if (!checkpoints_.drop_oldest()) restart();  // more samples between two checkpoints than the ring holds
  forget_before_oldest();
}

/// Removes the events that are part of the oldest state.
void DelayedFusionBuffer::forget_before_oldest() {
  const Checkpoint& oldest = checkpoints_.oldest();
  first_imu_ = oldest.next_imu;
  const auto kept = std::find_if(aiding_.begin(), aiding_.end(), [&](const AidingMeasurement& aiding) {
    return order_key(aiding) >= oldest.state.imu.time_ns;
  });
  const auto dropped = static_cast<std::size_t>(kept - aiding_.begin());
  aiding_.erase(aiding_.begin(), kept);
  next_aiding_ -= std::min(next_aiding_, dropped);
}

History DelayedFusionBuffer::history() const {
  History history;
  history.stamps_are_ahead = stamps_are_ahead_;
  if (checkpoints_.empty()) return history;
  history.base = checkpoints_.oldest().state;
  for (std::uint64_t i = first_imu_; i < end_imu_; ++i) history.imu.push_back(imu_[i % imu_.size()]);
  for (const AidingMeasurement& aiding : aiding_) {
    if (const auto* fix = std::get_if<FixMeasurement>(&aiding)) {
      history.fixes.push_back(*fix);
    } else if (const auto* twist = std::get_if<TwistMeasurement>(&aiding)) {
      history.twists.push_back(*twist);
    } else {
      history.headings.push_back(*std::get_if<HeadingMeasurement>(&aiding));
    }
  }
  return history;
}

void DelayedFusionBuffer::restore(const settings::Settings& settings, const History& history) {
  clear();
  if (history.base.imu.time_ns == 0) return;
  stamps_are_ahead_ = history.stamps_are_ahead;
  now_ = history.base;
  save_checkpoint();
  const std::size_t samples = std::min(history.imu.size(), imu_capacity);
  for (auto imu = history.imu.end() - static_cast<std::ptrdiff_t>(samples); imu != history.imu.end(); ++imu) {
    make_place_for_imu();
    imu_at(end_imu_++) = *imu;
  }
  time_ns_ = samples == 0 ? history.base.imu.time_ns : history.imu.back().time_ns;
  const auto has_place = [this] { return aiding_.size() < aiding_capacity; };
  for (const FixMeasurement& fix : history.fixes) {
    if (has_place()) insert(fix);
  }
  for (const HeadingMeasurement& heading : history.headings) {
    if (has_place()) insert(heading);
  }
  for (const TwistMeasurement& twist : history.twists) {
    if (has_place()) insert(twist);
  }
  replay(settings, nullptr);
}

}  // namespace sonopose::estimation::kalman
