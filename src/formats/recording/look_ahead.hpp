#pragma once
/// \file
/// Leaves out IMU samples whose stamps are far ahead (merge.hpp). Private to this folder.

#include <sonopose/samples/samples.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::recording {

/// Compares correctly even if the difference does not fit into a TimeNs.
inline bool is_later_by_more(TimeNs later, TimeNs earlier, std::uint64_t by_ns) {
  return later > earlier && static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier) > by_ns;
}

/// IMU samples from any source, without those whose stamps are far ahead.
template <class ImuSamples>
class LookAhead {
public:
  explicit LookAhead(ImuSamples samples) : samples_(std::move(samples)) { look_ahead(); }

  [[nodiscard]] const ImuSample* current() const { return in_view_.empty() ? nullptr : &in_view_.front(); }

  void step() {
    before_ns_ = in_view_.front().sensor_time_ns;
    ++passed_;
    in_view_.pop_front();
    look_ahead();
  }

  [[nodiscard]] std::size_t expected_count() const { return in_view_.size() + samples_.expected_count(); }

  /// One sentence about the samples that were left out, if there are any.
  [[nodiscard]] std::vector<std::string> warnings(const std::string& name) const {
    if (left_out_ == 0) return {};
    return {
        fmt::format("{}: {} of {} IMU samples are left out: stamped ahead of those that follow, the first "
                    "by {:.1f} s",
                    name, left_out_, passed_ + left_out_, first_ahead_s_)};
  }

private:
  static constexpr std::size_t max_ahead = 63;
  static constexpr std::size_t max_after = 128;
  static constexpr std::uint64_t far_ns = 1'000'000'000;

  void look_ahead() {
    for (;; in_view_.pop_front()) {
      for (; in_view_.size() <= max_after && samples_.current() != nullptr; samples_.step()) {
        in_view_.push_back(*samples_.current());
      }
      const auto follows_ns = stamp_ahead_of();
      if (!follows_ns) return;
      const TimeNs expected_ns = before_ns_.value_or(*follows_ns);
      if (left_out_++ == 0) first_ahead_s_ = seconds_between(expected_ns, in_view_.front().sensor_time_ns);
    }
  }

  /// The stamp at which a file goes on after samples that are stamped ahead, if the first in view is one: far
  /// ahead of it and of the sample before. Neither a silence nor a file in reverse order has one.
  [[nodiscard]] std::optional<TimeNs> stamp_ahead_of() const {
    if (in_view_.empty()) return std::nullopt;
    const TimeNs stamp_ns = in_view_.front().sensor_time_ns;
    if (before_ns_ && !is_later_by_more(stamp_ns, *before_ns_, far_ns)) return std::nullopt;
    const auto step_back = std::adjacent_find(
        in_view_.begin(), in_view_.end(), [](const ImuSample& earlier, const ImuSample& later) {
          return is_later_by_more(earlier.sensor_time_ns, later.sensor_time_ns, far_ns);
        });
    if (step_back == in_view_.end()) return std::nullopt;
    const auto ahead = static_cast<std::size_t>(step_back - in_view_.begin()) + 1;
    if (ahead > max_ahead || 2 * ahead > in_view_.size()) return std::nullopt;
    std::vector<TimeNs> after_ns;  // one of three may be wrong too
    for (auto each = step_back + 1; each != in_view_.end() && after_ns.size() < 3; ++each)
      after_ns.push_back(each->sensor_time_ns);
    std::sort(after_ns.begin(), after_ns.end());
    const TimeNs next_ns = after_ns[std::min<std::size_t>(1, after_ns.size() - 1)];
    return is_later_by_more(stamp_ns, next_ns, far_ns) ? std::optional(next_ns) : std::nullopt;
  }

  ImuSamples samples_;
  std::deque<ImuSample> in_view_;
  std::optional<TimeNs> before_ns_;  ///< stamp of the previous sample
  std::size_t passed_ = 0;
  std::size_t left_out_ = 0;
  double first_ahead_s_ = 0.0;  ///< lead of the first sample that was left out
};

}  // namespace sonopose::recording
