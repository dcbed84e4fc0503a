#pragma once
/// \file
/// The topics of a rosbag2 recording that are the inputs of the fusion.

#include "ros2/bag/storage.hpp"
#include "ros2/inputs/aiding_input.hpp"
#include "ros2/inputs/input_option.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2::bag {

/// Topics as on the command line of the relay, whose addresses may be absent: "/tag/pose:PointStamped".
struct TopicChoice {
  std::vector<std::string> imu{};
  std::vector<std::string> fix{};
  std::map<AidingInput::Kind, std::vector<std::string>> aiding{};
  std::optional<Wheels> wheels{};      ///< value of --wheels
  std::optional<std::string> truth{};  ///< topic of Odometry, PoseStamped or PoseWithCovarianceStamped
  std::string base_frame = "base_link";
  std::string map_frame = "map";
  ImuMeaning imu_meaning = ImuMeaning::unknown;

  [[nodiscard]] bool is_given() const {
    return !imu.empty() || !fix.empty() || !aiding.empty() || wheels.has_value() || truth.has_value();
  }
};

/// Sets the choice for all recordings that this process reads, before one is read. Throws
/// std::invalid_argument that names option and fault.
void choose_topics(TopicChoice choice);
const TopicChoice& chosen_topics();

/// The inputs of one beacon, and their topics in the storage.
struct Inputs {
  struct OfInput {
    Input option;
    std::size_t topic = 0;
  };
  struct OfAiding {
    AidingInput option;
    std::size_t topic = 0;
  };
  BeaconAddress address = 0;
  std::vector<OfInput> inputs{};
  std::vector<OfAiding> aidings{};
  std::optional<std::size_t> truth{};
  std::vector<std::string> notes{};  ///< topics that were chosen by type
};

/// Finds the chosen topics. Without a choice of IMU or fixes, the only topic of that type with messages is
/// one. `needs_fixes`: false if only IMU samples are wanted. Throws files::IoError that lists the topics if
/// one is missing, of another type, or not unique.
Inputs find_inputs(const Storage& storage, const TopicChoice& choice, std::optional<BeaconAddress> address,
                   bool needs_fixes);

/// Returns true for a topic whose messages can be inputs.
bool is_usable(const BagTopic& topic);

/// "/imu/data (sensor_msgs/msg/Imu, 200 messages)".
std::string with_type(const BagTopic& topic);

}  // namespace sonopose::ros2::bag
