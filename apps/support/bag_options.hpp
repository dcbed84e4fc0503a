#pragma once
// The topics of recordings of rosbag2, common to all programs that read the inputs of the fusion.

#include "ros2/bag/topic_choice.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::apps {

/// Adds --imu-in, --fix-in and so on, which apply to all recordings of the program.
inline void add_bag_options(CLI::App& app) {
  using ros2::bag::TopicChoice;
  const char* const group = "Recordings of ROS 2";
  const auto change = [](const auto& set) {
    TopicChoice choice = ros2::bag::chosen_topics();
    set(choice);
    try {
      ros2::bag::choose_topics(std::move(choice));
    } catch (const std::invalid_argument& error) {
      throw CLI::ValidationError(error.what());
    }
  };
  const auto add = [&](const char* name, std::vector<std::string> TopicChoice::*topics, const char* what,
                       const char* type) {
    app.add_option_function<std::vector<std::string>>(
           name,
           [change, topics](const std::vector<std::string>& given) {
             change([&](TopicChoice& choice) { choice.*topics = given; });
           },
           what)
        ->type_name(type)
        ->allow_extra_args(false)
        ->group(group);
  };
  const auto add_text = [&](const char* name, const auto& set, const char* what, const char* type) {
    app.add_option_function<std::string>(
           name,
           [change, set](const std::string& given) {
             change([&](TopicChoice& choice) { set(choice, given); });
           },
           what)
        ->type_name(type)
        ->group(group);
  };
  add("--imu-in", &TopicChoice::imu,
      "Topic of sensor_msgs/Imu; two for accelerometer and gyroscope (default: the only one)",
      "TOPIC[=ADDRESS]");
  add("--fix-in", &TopicChoice::fix,
      "Topic of PointStamped or PoseWithCovarianceStamped with the fixes; /tag:TYPE chooses (default: the "
      "only one)",
      "TOPIC[=ADDRESS][@PLACE]");
  add("--odom-in", &TopicChoice::odom, "Topic of Odometry whose twist is the velocity (default: none)",
      "TOPIC[=ADDRESS]");
  add("--twist-in", &TopicChoice::twist,
      "Topic of TwistWithCovarianceStamped, or with :TwistStamped that (default: none)", "TOPIC[=ADDRESS]");
  add_text(
      "--truth-in", [](TopicChoice& choice, const std::string& topic) { choice.truth = topic; },
      "Topic of Odometry, PoseStamped or PoseWithCovarianceStamped with the truth (default: none)", "TOPIC");
  add_text(
      "--base-frame", [](TopicChoice& choice, const std::string& frame) { choice.base_frame = frame; },
      "Frame of velocities, tags and truth; /tf_static says where the IMU is in it (default: base_link)",
      "FRAME");
  app.add_option_function<std::string>(
         "--imu-meaning",
         [change](const std::string& word) {
           change([&](TopicChoice& choice) {
             const auto at = std::ranges::find(imu_meaning_words, word) - imu_meaning_words.begin();
             choice.imu_meaning = static_cast<ImuMeaning>(at);
           });
         },
         "What the samples are: the value at their instant, or the mean since the previous one")
      ->check(CLI::IsMember(std::vector<std::string>(imu_meaning_words.begin(), imu_meaning_words.end())))
      ->group(group);
}

}  // namespace sonopose::apps
