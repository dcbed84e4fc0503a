#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/aiding/delay.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/estimation/offline/judgement.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/preset.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

namespace sonopose::estimation::offline {

using kalman::AidingMeasurement;
using kalman::FixMeasurement;
using kalman::FixOutcome;
using kalman::HeadingMeasurement;
using kalman::ImuMeasurement;
using kalman::State;

namespace {

struct NumberedAiding {
  AidingMeasurement aiding;
  std::uint64_t sequence = 0;
};

/// Events that the engine admitted between two resets, in ascending time.
struct Admitted {
  std::vector<ImuMeasurement> imu;
  std::vector<NumberedAiding> aidings;
};

/// Finds what the engine admits by running it.
class Admission {
public:
  explicit Admission(const settings::Settings& settings) : engine_(settings), admitted_(1) {}

  void add(const ImuSample& raw) {
    const std::uint32_t resets = engine_.reset_counter();
    const bool used = engine_.predict(raw).has_value();
    if (engine_.reset_counter() != resets) admitted_.emplace_back();
    if (!used) return;
    const ImuMeasurement imu = engine_.measurement_in(raw);
    drop_future(imu.time_ns);
    admitted_.back().imu.push_back(imu);
  }

  void add(const UltrasonicFix& given) {
    const UltrasonicFix fix = aiding::at_arrival(given, engine_.time_ns());
    const FixMeasurement measured = engine_.measurement_in(fix);
    constexpr std::uint32_t refused = fix_low_quality | fix_invalid | fix_too_late;
    const std::uint64_t before = engine_.counters().headings;
    const bool is_refused = (engine_.correct(fix).flags & refused) != 0;
    if (set_heading_ && engine_.counters().headings != before) insert(*set_heading_);
    if (!is_refused) insert({measured, fix.sequence});
  }

  void add(const PairHeading& given) {
    const PairHeading heading = aiding::at_arrival(given, engine_.time_ns());
    const HeadingMeasurement measured = engine_.measurement_in(heading);
    const std::uint64_t before = engine_.counters().headings;
    engine_.correct(heading);
    if (measured.restarts) set_heading_ = {measured, heading.sequence};
    if (heading.valid && engine_.counters().headings != before) insert({measured, heading.sequence});
  }

  void add(const TwistSample& twist) {
    const kalman::TwistMeasurement measured = engine_.measurement_in(twist);
    const std::uint64_t before = engine_.counters().twists_used + engine_.counters().twists_rejected;
    engine_.correct(twist);
    if (engine_.counters().twists_used + engine_.counters().twists_rejected != before) {
      insert({measured, twist.sequence});
    }
  }

  std::vector<Admitted> finished() { return std::move(admitted_); }

private:
  void insert(const NumberedAiding& numbered) {
    auto& aidings = admitted_.back().aidings;
    const TimeNs turn_ns = kalman::order_key(numbered.aiding);
    const auto is_later = [&](const NumberedAiding& other) {
      const TimeNs other_ns = kalman::order_key(other.aiding);
      return other_ns > turn_ns || (other_ns == turn_ns && other.aiding.index() > numbered.aiding.index());
    };
    auto place = aidings.end();
    while (place != aidings.begin() && is_later(*(place - 1))) --place;
    // The same measurement may come twice.
    constexpr TimeNs remembered_ns = 2'000'000'000;
    for (auto before = place;
         before != aidings.begin() && kalman::order_key((before - 1)->aiding) >= turn_ns - remembered_ns;
         --before) {
      if (kalman::is_copy((before - 1)->aiding, numbered.aiding)) return;
    }
    aidings.insert(place, numbered);
  }

  /// Drops fixes and headings whose stamps an IMU sample contradicts, as the engine does.
  void drop_future(TimeNs now_ns) {
    auto& aidings = admitted_.back().aidings;
    const TimeNs latest_ns = now_ns + to_ns(aiding::admission::future_tolerance_s);
    while (!aidings.empty() && kalman::order_key(aidings.back().aiding) > latest_ns) aidings.pop_back();
  }

  kalman::Engine engine_;
  std::optional<NumberedAiding> set_heading_;  ///< heading of a pose that the user sets; counts with its fix
  std::vector<Admitted> admitted_;
};

/// Replaces the readings of a sensor that the engine drops, and notes that the motion is uncertain.
void drop_wrong_readings(Segment& segment, Vector3d ImuMeasurement::*reading, double max_jump,
                         Vector3d DroppedMotion::*motion) {
  kalman::SpikeFilter spikes;
  std::vector<ImuMeasurement>& imu = segment.imu;
  std::size_t last = 0;  // sample before the held ones
  const auto drop = [&](std::size_t end, TimeNs time_ns, const Vector3d& integral_body) {
    for (std::size_t k = last + 1; k < end; ++k) imu[k].*reading = imu[last].*reading;
    segment.dropped.push_back({.time_ns = time_ns});
    segment.dropped.back().*motion = integral_body;
  };
  for (std::size_t i = 1; i < imu.size(); ++i) {
    const double dt_s = seconds_between(imu[i - 1].time_ns, imu[i].time_ns);
    const auto output = spikes.add(imu[last].*reading, imu[i].*reading, dt_s, max_jump);
    if (spikes.held_s > 0.0) continue;
    if (!output.dropped_body.isZero(0.0)) drop(i, imu[i].time_ns, output.dropped_body);
    imu[i].*reading = output.reading_body;
    last = i;
  }
  if (spikes.held_s > 0.0) drop(imu.size(), imu.back().time_ns, spikes.excess_integral_body);
}

void drop_wrong_readings(Segment& segment) {
  drop_wrong_readings(segment, &ImuMeasurement::force_body_mps2, kalman::max_jump_mps2,
                      &DroppedMotion::impulse_body_mps);
  drop_wrong_readings(segment, &ImuMeasurement::rate_body_radps, kalman::max_jump_radps,
                      &DroppedMotion::turn_body_rad);
  std::stable_sort(segment.dropped.begin(), segment.dropped.end(),
                   [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; });
}

/// Runs the engine's state over admitted measurements in their order and collects the verdicts. The engine
/// arrives at the same verdicts after repeating what followed each late measurement. With a fast IMU there
/// are tiny differences: the engine also makes the pending steps at checkpoints.
class Judge {
public:
  explicit Judge(const settings::Settings& settings) : settings_(settings) {}

  void add(const ImuMeasurement& imu) {
    const kalman::ImuOutcome outcome = state_.on_imu(settings_, imu);
    if (!is_running()) {
      waiting_.push_back(imu);
      return;
    }
    if (state_.imu.in_gap) {
      segments_.emplace_back();
      tracking_since_ns_ = 0;
    }
    Segment& segment = segments_.back();
    segment.imu.push_back(imu);
    segment.nominal_imu_period_s = state_.imu.nominal_imu_period_s;
    if (outcome.still) {
      segment.states.push_back(
          {imu.time_ns, kalman::at_gyro_bias, state_.rest.still_gyro_mean, outcome.still_rate_variance});
    }
    if (outcome.zero_velocity_variance > 0.0) {
      segment.states.push_back(
          {imu.time_ns, kalman::at_velocity, Vector3d::Zero(), outcome.zero_velocity_variance});
    }
    store_settled_filter();
  }

  void add(const FixMeasurement& fix, std::uint64_t sequence) {
    const kalman::FrozenTrackDetector before = state_.frozen_track;
    const FixOutcome outcome = state_.on_fix(settings_, fix);
    if (outcome.starts) begin(fix.time_ns);
    if (!is_running()) return;
    JudgedFix judged{.measured = fix,
                     .sequence = sequence,
                     .flags = outcome.flags,
                     .used = (outcome.flags & fix_used) != 0,
                     .covariance_world_m2 = outcome.covariance_world_m2};
    if (judged.used && outcome.test_ratio > 1.0) {
      judged.track_change =
          TrackChange{outcome.jump_world_m, outcome.velocity_change_world_mps, outcome.yaw_change_rad};
    }
    if (state_.frozen_track.frozen && !before.frozen) reject_repeated_fixes(before);
    segments_.back().fixes.push_back(judged);
  }

  void add(const HeadingMeasurement& heading, std::uint64_t sequence) {
    const kalman::HeadingOutcome outcome = state_.on_heading(settings_, heading);
    if (!is_running()) return;
    segments_.back().headings.push_back({.measured = heading,
                                         .sequence = sequence,
                                         .used = outcome.used,
                                         .variance_rad2 = outcome.variance_rad2,
                                         .added_yaw_variance_rad2 = outcome.added_variance_rad2});
  }

  /// A velocity has no part in a segment; it only affects the verdicts.
  void add(const kalman::TwistMeasurement& twist, std::uint64_t /*sequence*/) {
    state_.on_twist(settings_, twist);
  }

  std::vector<Segment> finished() {
    for (Segment& segment : segments_) drop_wrong_readings(segment);
    return std::move(segments_);
  }

private:
  /// True if the estimate has started and does not wait for a restart.
  [[nodiscard]] bool is_running() const {
    return !segments_.empty() && state_.phase != kalman::Phase::waiting && !state_.restart_pending;
  }

  void begin(TimeNs time_ns) {
    constexpr double max_imu_lead_s = 1.0;
    const auto first = std::find_if(waiting_.begin(), waiting_.end(), [&](const ImuMeasurement& imu) {
      return seconds_between(imu.time_ns, time_ns) <= max_imu_lead_s;
    });
    segments_.emplace_back().imu.assign(first, waiting_.end());
    waiting_.clear();
    tracking_since_ns_ = 0;
  }

  /// Keeps the filter until some seconds after the yaw became known.
  void store_settled_filter() {
    constexpr double settling_s = 5.0;
    if (state_.phase == kalman::Phase::tracking && tracking_since_ns_ == 0) {
      tracking_since_ns_ = state_.imu.time_ns;
    }
    const bool settled =
        tracking_since_ns_ != 0 && seconds_between(tracking_since_ns_, state_.imu.time_ns) > settling_s;
    if (settled) return;
    kalman::Filter& kept = segments_.back().settled;
    kept = state_.filter();
    static_cast<kalman::NominalState&>(kept) = state_.nominal();  // after the pending steps
    segments_.back().settled_ns = state_.imu.time_ns;
  }

  void reject_repeated_fixes(const kalman::FrozenTrackDetector& detector) {
    auto& fixes = segments_.back().fixes;
    const auto repeats = std::min(fixes.size(), static_cast<std::size_t>(detector.repeats));
    for (auto fix = fixes.end() - static_cast<std::ptrdiff_t>(repeats); fix != fixes.end(); ++fix) {
      if (fix->measured.time_ns <= detector.began_ns) continue;
      fix->used = false;
      fix->flags = fix_frozen;
    }
  }

  const settings::Settings& settings_;
  State state_;
  std::vector<ImuMeasurement> waiting_;  ///< samples while no estimate runs
  TimeNs tracking_since_ns_ = 0;
  std::vector<Segment> segments_;
};

void judge(Judge& judge, const Admitted& admitted) {
  auto imu = admitted.imu.begin();
  const auto add_imu_until = [&](TimeNs time_ns) {
    for (; imu != admitted.imu.end() && imu->time_ns <= time_ns; ++imu) judge.add(*imu);
  };
  for (const NumberedAiding& numbered : admitted.aidings) {
    add_imu_until(kalman::order_key(numbered.aiding));
    std::visit([&](const auto& measured) { judge.add(measured, numbered.sequence); }, numbered.aiding);
  }
  add_imu_until(std::numeric_limits<TimeNs>::max());
}

}  // namespace

std::vector<Segment> judged(const settings::Settings& settings, std::span<const Event> events) {
  Admission admission(settings);
  for (const Event& event : events) {
    std::visit([&](const auto& sample) { admission.add(sample); }, event);
  }
  const settings::Settings resolved = settings::resolved(settings);
  std::vector<Segment> segments;
  for (const Admitted& admitted : admission.finished()) {
    Judge one(resolved);
    judge(one, admitted);
    for (Segment& segment : one.finished()) segments.push_back(std::move(segment));
  }
  return segments;
}

}  // namespace sonopose::estimation::offline
