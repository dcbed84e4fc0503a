#pragma once
/// \file
/// What is told of one topic that comes in from ROS 2: silence, losses, foreign frames. Values in, text out.

#include "ros2/relay/input_option.hpp"

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::ros2 {

/// What the middleware says of the readers of one topic.
struct Ros2InputEnds {
  std::uint64_t publishers = 0;          ///< that match now
  std::uint64_t publishers_refused = 0;  ///< whose QoS did not match, since the start
  std::uint64_t samples_lost = 0;        ///< since the start
};

/// One topic. Times are of the steady clock. Not for several threads at once: no locks.
class Ros2InputDetector {
public:
  using Lines = std::vector<std::string>;

  /// An input without a usable sample for longer than `timeout_ns` is silent. One that was never heard is
  /// given `first_sample_ns` at the least, counted from `now`: publishers have to be found first.
  /// `map_frame` is the frame that fixes are taken to be in.
  Ros2InputDetector(Ros2Input input, std::string map_frame, TimeNs timeout_ns, SteadyTime now);

  static constexpr TimeNs first_sample_ns = 2'000'000'000;

  /// A usable sample, with the frame that its header names. A fix in a frame that is not the map, and an IMU
  /// sample in another frame than the first one's, add a line: once for each such frame.
  void on_sample(std::string_view frame, SteadyTime now, Lines& lines);

  /// Adds to `lines` what fell silent, and why as far as is known, what is heard again, and, once a second at
  /// the most, what was lost. To be called many times a second.
  void look(const Ros2InputEnds& ends, SteadyTime now, Lines& lines);

private:
  struct Silence {
    SteadyTime since;
    bool is_first = false;  ///< it was never heard before
  };

  void look_for_silence(const Ros2InputEnds& ends, SteadyTime now, Lines& lines);
  void log_silence(const Ros2InputEnds& ends, SteadyTime now, Lines& lines);
  void look_for_losses(const Ros2InputEnds& ends, SteadyTime now, Lines& lines);
  void log_foreign_frame(std::string_view frame, Lines& lines);
  [[nodiscard]] const char* what() const;
  [[nodiscard]] std::string reason(const Ros2InputEnds& ends) const;

  Ros2Input input_;
  TimeNs timeout_ns_;
  SteadyTime latest_;
  bool heard_ = false;
  std::optional<Silence> silence_;
  std::uint64_t reported_refused_ = 0;
  std::uint64_t reported_lost_ = 0;
  std::optional<SteadyTime> reported_lost_at_;
  std::optional<std::string> expected_frame_;
  std::vector<std::string> foreign_frames_;
};

/// Host time − sender's time (s): the smallest of the last second. The others are the same plus what the
/// samples waited for on their way.
class SmallestOffset {
public:
  /// `now`: rising.
  void add(double offset_s, SteadyTime now);

  /// 0 where there was none yet; the last one known where nothing came since.
  [[nodiscard]] double value_s() const { return rising_.empty() ? 0 : rising_.front().second; }

private:
  /// Time and offset: each offset is the smallest of those that came after the one before it.
  std::deque<std::pair<SteadyTime, double>> rising_;
};

}  // namespace sonopose::ros2
