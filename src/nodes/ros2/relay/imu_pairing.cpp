#include "ros2/relay/imu_pairing.hpp"

#include <algorithm>

namespace sonopose::ros2::relay {

std::optional<ImuSample> ImuPairing::on(const FusedPose& pose, SteadyTime now) {
  const auto end = samples_.begin() + static_cast<std::ptrdiff_t>(std::min(sample_count_, max_kept));
  const auto found = std::find_if(
      samples_.begin(), end, [&pose](const ImuSample& sample) { return sample.sequence == pose.sequence; });
  if (found != end) return *found;
  if (waiting_count_ == max_kept) give_up_first();
  waiting_[(first_waiting_ + waiting_count_++) % max_kept] = {pose, now};
  return std::nullopt;
}

std::optional<FusedPose> ImuPairing::on(const ImuSample& sample) {
  const bool restarted = sample.sequence <= latest_sequence_;  // a new bridge numbers from 1
  if (!first_sequence_ || restarted) first_sequence_ = sample.sequence;
  latest_sequence_ = sample.sequence;
  samples_[sample_count_++ % max_kept] = sample;
  while (waiting_count_ > 0 && (waiting_[first_waiting_].pose.sequence < sample.sequence ||
                                (restarted && waiting_[first_waiting_].pose.sequence > sample.sequence))) {
    give_up_first();
  }
  if (waiting_count_ == 0 || waiting_[first_waiting_].pose.sequence != sample.sequence) return std::nullopt;
  const FusedPose pose = waiting_[first_waiting_].pose;
  remove_first();
  return pose;
}

void ImuPairing::drop_overdue(SteadyTime now) {
  while (waiting_count_ > 0 && now - waiting_[first_waiting_].since > timeout_ns) give_up_first();
}

void ImuPairing::give_up_first() {
  if (first_sequence_ && waiting_[first_waiting_].pose.sequence > *first_sequence_) ++given_up_;
  remove_first();
}

void ImuPairing::remove_first() {
  first_waiting_ = (first_waiting_ + 1) % max_kept;
  --waiting_count_;
}

}  // namespace sonopose::ros2::relay
