#pragma once
/// \file
/// A rosbag2 recording as the inputs of the fusion.

#include "recording/log_folder.hpp"
#include "ros2/bag/storage.hpp"
#include "ros2/bag/topic_choice.hpp"

#include <optional>
#include <string>
#include <vector>

namespace sonopose::ros2::bag {

struct BagLog {
  recording::SensorLog log;
  std::vector<std::string> notes;  ///< topics that were used, and topics that were not
};

/// Reads one beacon by the rules of the relay. Events are in the order of reception by the recorder, numbered
/// from 1. Velocities and truth are moved to the IMU by the transform from `choice.base_frame` to its frame
/// in /tf_static. `needs_fixes`: as of find_inputs. Throws files::IoError.
BagLog read_bag(const Storage& storage, const TopicChoice& choice, std::optional<BeaconAddress> address,
                bool needs_fixes = true);

}  // namespace sonopose::ros2::bag
