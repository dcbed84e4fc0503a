#pragma once
/// \file
/// Detects events of one input topic for the log: silence, losses, unexpected frames. Without I/O: returns
/// lines that another thread than that of the samples formats.

#include "logging/log.hpp"
#include "ros2/inputs/input_option.hpp"

#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::ros2 {

/// Discovery and counters of the readers of one topic.
struct InputEndpoints {
  std::uint64_t publishers = 0;               ///< currently matched publishers
  std::uint64_t publishers_incompatible = 0;  ///< publishers with incompatible QoS, since the start
  std::uint64_t samples_lost = 0;             ///< since the start
};

/// Monitors one topic. Times are of the steady clock. Not thread-safe.
class InputMonitor {
public:
  /// A line with its level, formatted on any thread during the life of the monitor.
  struct Line {
    std::function<std::string()> text;
    logging::Level level = logging::Level::warning;
  };
  using Lines = std::vector<Line>;

  /// An input is silent without a valid sample for longer than `timeout_ns`. Until its first sample, the
  /// timeout is at least `first_sample_ns` after `now`, for discovery. `map_frame`: expected frame of fixes.
  InputMonitor(Input input, std::string map_frame, TimeNs timeout_ns, SteadyTime now);
  ~InputMonitor() = default;
  InputMonitor(const InputMonitor&) = delete;
  InputMonitor& operator=(const InputMonitor&) = delete;

  static constexpr TimeNs first_sample_ns = 2'000'000'000;

  /// Takes a valid sample with the frame of its header. Adds a line for each new frame other than the map
  /// (fixes) or the frame of the first sample (others).
  void on_sample(std::string_view frame, SteadyTime now, Lines& lines);

  /// Deviation of a driver from what is expected.
  enum class Notice : std::uint8_t {
    no_angular_velocity,
    no_specific_force,
    joined,      ///< samples of accelerometer and gyroscope are joined
    second_imu,  ///< another topic of this beacon has complete samples
    covariance,  ///< a covariance is unusable
    repeats,     ///< positions come again
    no_stamp,    ///< messages have the stamp 0
    publishers,  ///< several publishers take turns
    clocks       ///< its stamps and those of the IMU are of different clocks
  };

  /// Adds a line about a notice, the first time. `detail`: the cause, or the other topic.
  void on_notice(Notice notice, const std::function<std::string()>& detail, Lines& lines);

  /// Adds a line about what is not used, once for each of the first few reasons.
  void on_unused(const std::string& why, Lines& lines);

  /// Adds lines for the start of a silence, with its probable cause, for its end, and, at most once per
  /// second, for losses. Call it many times per second.
  void update(const InputEndpoints& endpoints, SteadyTime now, Lines& lines);

private:
  struct Silence {
    SteadyTime since;
    bool is_first = false;  ///< before the first sample
  };

  void check_silence(const InputEndpoints& endpoints, SteadyTime now, Lines& lines);
  void log_silence(const InputEndpoints& endpoints, SteadyTime now, Lines& lines);
  void check_losses(const InputEndpoints& endpoints, SteadyTime now, Lines& lines);
  void log_unexpected_frame(std::string_view frame, Lines& lines);
  [[nodiscard]] const char* samples_text() const;
  [[nodiscard]] std::string lost_text(std::uint64_t count) const;
  /// Describes the cause of a silence. Reads constants only, as the above.
  [[nodiscard]] std::string cause(const InputEndpoints& endpoints, bool is_partial) const;
  [[nodiscard]] std::string text_of(Notice notice, const std::string& detail) const;

  const Input input_;  // read by lines
  TimeNs timeout_ns_;
  SteadyTime latest_;
  bool received_ = false;
  std::optional<Silence> silence_;
  std::uint64_t reported_incompatible_ = 0;
  std::uint64_t reported_lost_ = 0;
  std::optional<SteadyTime> reported_lost_at_;
  std::optional<std::string> expected_frame_;
  std::vector<std::string> unexpected_frames_;
  std::set<Notice> noticed_;
  std::set<std::string> unused_;
};

/// Describes a topic whose stamps are older than those of the IMU by this time (negative: newer), with the
/// remedy.
std::string clocks_text(double older_s, Input::Kind kind, const std::string& imu_topic);

/// Minimum of host time − sender's time (s) over the last second. It excludes the varying part of the
/// transport delay.
class SmallestOffset {
public:
  /// `now` must increase.
  void add(double offset_s, SteadyTime now);

  /// Minimum; 0 before the first sample. Without new samples, the last known value.
  [[nodiscard]] double value_s() const { return rising_.empty() ? 0 : rising_.front().second; }

private:
  /// Monotonic queue of time and offset, both increasing: each offset is the minimum since the previous
  /// entry.
  std::deque<std::pair<SteadyTime, double>> rising_;
};

}  // namespace sonopose::ros2
