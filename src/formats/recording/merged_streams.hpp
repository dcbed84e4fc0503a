#pragma once
/// \file
/// Merges streams of samples from any source (merge.hpp). Private to this folder.

#include "recording/log_folder.hpp"
#include "recording/look_ahead.hpp"
#include "recording/step_back.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::recording {

/// Samples in memory, one at a time.
template <class Sample>
class Samples {
public:
  explicit Samples(const std::vector<Sample>& samples) : samples_(samples) {}
  [[nodiscard]] const Sample* current() const { return next_ < samples_.size() ? &samples_[next_] : nullptr; }
  void step() { ++next_; }
  [[nodiscard]] std::size_t expected_count() const { return samples_.size(); }

private:
  const std::vector<Sample>& samples_;
  std::size_t next_ = 0;
};

/// merge_by_availability with IMU samples from any source; `open_imu()` returns them once more.
template <class ImuSamples, class OpenImu>
SensorLog merged(const std::string& name, ImuSamples imu_samples, const OpenImu& open_imu,
                 Samples<UltrasonicFix> all_fixes, Samples<PairHeading> all_headings,
                 Samples<TwistSample> all_twists) {
  std::vector<StepsBack> steps{
      {}, steps_back_of(all_fixes), steps_back_of(all_headings), steps_back_of(all_twists)};
  // Reads the IMU samples twice only for a log whose clock may have been set back.
  const bool may_be_cut = std::ranges::any_of(steps, [](const auto& of) { return !of.found().empty(); });
  if (may_be_cut) steps.front() = steps_back_of(LookAhead{open_imu()});
  const auto cuts = cuts_at_common_steps(steps);
  Pieces imu{LookAhead(std::move(imu_samples)), cuts[0]};
  Pieces fixes(all_fixes, cuts[1]);
  Pieces headings(all_headings, cuts[2]);
  Pieces twists(all_twists, cuts[3]);
  SensorLog log;
  std::vector<Event>& events = log.events;
  events.reserve(imu.stream().expected_count() + all_fixes.expected_count() + all_headings.expected_count() +
                 all_twists.expected_count());
  const auto append = [&events](auto& samples) {
    auto sample = *samples.current();
    sample.sequence = events.size() + 1;
    events.emplace_back(std::move(sample));
    samples.step();
  };
  const auto next_ns = [](const auto& samples) {
    return samples.current() != nullptr ? available_at_ns(*samples.current())
                                        : std::numeric_limits<TimeNs>::max();
  };
  std::size_t pieces_left = cuts[0].size();
  while (true) {
    if (imu.current() == nullptr && fixes.current() == nullptr && headings.current() == nullptr &&
        twists.current() == nullptr) {
      if (pieces_left-- == 0) break;
      imu.begin_next();
      fixes.begin_next();
      headings.begin_next();
      twists.begin_next();
      continue;
    }
    const TimeNs next_event_ns = std::min({next_ns(imu), next_ns(fixes), next_ns(headings), next_ns(twists)});
    const auto is_next = [&](const auto& samples) {
      return samples.current() != nullptr && next_ns(samples) == next_event_ns;
    };
    if (is_next(imu)) {
      append(imu);
    } else if (is_next(fixes)) {
      append(fixes);
    } else if (is_next(headings)) {
      append(headings);
    } else {
      append(twists);
    }
  }
  log.warnings = imu.stream().warnings(name);
  return log;
}

}  // namespace sonopose::recording
