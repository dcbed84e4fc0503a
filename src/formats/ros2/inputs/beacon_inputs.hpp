#pragma once
/// \file
/// The rules by which the messages of a beacon's drivers become its samples.

#include "ros2/inputs/fix_repeats.hpp"
#include "ros2/inputs/imu_joiner.hpp"
#include "ros2/inputs/input_frames.hpp"
#include "ros2/inputs/input_monitor.hpp"
#include "ros2/inputs/input_option.hpp"
#include "ros2/inputs/publisher_mix.hpp"
#include "ros2/inputs/stamp_clock.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/input.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::ros2 {

/// A topic with its monitor. `timeout_ns`, `now`: as of the monitor.
struct MonitoredInput {
  MonitoredInput(const Input& input, std::string map_frame, TimeNs timeout_ns, SteadyTime now)
      : option(input), monitor(input, std::move(map_frame), timeout_ns, now) {}

  Input option;
  InputMonitor monitor;
  PublisherMix publishers;
  FixRepeats repeats;     ///< for a topic of fixes, like the next two
  SmallestOffset offset;  ///< age of its samples at their arrival
  std::optional<SteadyTime> since{};
  std::uint64_t unstamped = 0;  ///< messages without a stamp, whose arrival is their time
};

/// One beacon: joins the samples of two sensors, leaves out repeated fixes, and notices what drivers do. Not
/// thread-safe.
class BeaconInputs {
public:
  /// The reception of a message: `received_ns` in the clock of ROS 2, `now` in that of the waits.
  struct Moment {
    TimeNs received_ns = 0;
    SteadyTime now;
    std::uint64_t publisher = 0;  ///< its identity; 0: unknown
  };
  using Lines = InputMonitor::Lines;

  /// Takes the beacon's inputs into account. Call it for each one before the first message.
  void add(const Input& input);

  /// Takes a message of an IMU, and appends the samples that are complete. Returns false if it is invalid.
  bool on(const Imu& message, MonitoredInput& input, Moment moment, std::vector<ImuSample>& ready,
          Lines& lines);
  bool on(const SensorCombined& message, MonitoredInput& input, Moment moment, std::vector<ImuSample>& ready,
          Lines& lines);

  struct TakenFix {
    bool is_valid = false;
    std::optional<UltrasonicFix> fix{};  ///< empty if it is invalid or repeated
    std::string unused{};                ///< reason if the place of its tag is not known
  };
  /// `frames`: needed if a topic of fixes has a place.
  TakenFix on(const PointStamped& message, MonitoredInput& input, Moment moment, const InputFrames& frames,
              Lines& lines);
  TakenFix on(const PoseWithCovarianceStamped& message, MonitoredInput& input, Moment moment,
              const InputFrames& frames, Lines& lines);

  /// Appends samples that have waited long enough.
  void update(SteadyTime now, std::vector<ImuSample>& ready, Lines& lines);

  /// Takes the time of measurement of an input other than those of `on`, for `check_clocks`.
  static void note_stamp(TimeNs measured_ns, MonitoredInput& input, Moment moment);

  /// Says that a message has no stamp, and counts it.
  static void notice_stamp(const Header& header, MonitoredInput& input, Lines& lines);

  /// Says that several publishers of its topic take turns. Call it for each measurement that is used.
  static void notice_publisher(MonitoredInput& input, Moment moment, Lines& lines);

  /// Warns of stamps that are of another clock than those of the IMU: each arrives soon after its
  /// stamp, and the least delay of the last second is compared.
  void check_clocks(MonitoredInput& input, SteadyTime now, Lines& lines) const;
  /// Time by which an input's messages arrive later after their stamps than those of the IMU.
  [[nodiscard]] double older_s(const MonitoredInput& input) const;

  /// Number of samples that lack a specific force, which are not used.
  [[nodiscard]] std::uint64_t dropped() const { return joiner_.dropped(); }
  /// Age of the IMU samples, or of the fixes without an IMU (SmallestOffset).
  [[nodiscard]] double offset_s() const { return offset_.value_s(); }
  /// Converts a time of reception to the clock of the stamps.
  [[nodiscard]] TimeNs stamp_at(TimeNs received_ns) const { return stamp_clock_.at(received_ns); }

private:
  void take(ReceivedImu& received, std::string_view frame, MonitoredInput& input, Moment moment,
            std::vector<ImuSample>& ready, Lines& lines);
  template <class Position>
  TakenFix take(const Position& message, MonitoredInput& input, Moment moment, const InputFrames& frames,
                Lines& lines);
  void notice_joined(Lines& lines);

  int imus_ = 0;
  StampClock stamp_clock_;
  ImuJoiner joiner_;
  MonitoredInput* complete_ = nullptr;    ///< input with complete IMU samples
  MonitoredInput* gyroscope_ = nullptr;   ///< input with angular velocities
  std::optional<std::string> imu_topic_;  ///< topic of the first sample
  SmallestOffset offset_;
};

}  // namespace sonopose::ros2
