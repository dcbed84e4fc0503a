#include "bag_options.hpp"

#include "ros2/bag/topic_choice.hpp"
#include "ros2/inputs/wheels_file.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::apps {

void add_bag_options(CommandLine& app) {
  using ros2::bag::TopicChoice;
  const char* const group = "Recordings of ROS 2";
  const auto change = [](const auto& set) {
    TopicChoice choice = ros2::bag::chosen_topics();
    set(choice);
    try {
      ros2::bag::choose_topics(std::move(choice));
    } catch (const std::invalid_argument& error) {
      refuse_command_line(error.what());
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
        .type_name(type)
        .allow_extra_args(false)
        .group(group);
  };
  const auto add_text = [&](const char* name, const auto& set, const char* what, const char* type) {
    app.add_option_function<std::string>(
           name,
           [change, set](const std::string& given) {
             change([&](TopicChoice& choice) { set(choice, given); });
           },
           what)
        .type_name(type)
        .group(group);
  };
  add("--imu-in", &TopicChoice::imu,
      "Topic of sensor_msgs/Imu; two for accelerometer and gyroscope (default: the only one)",
      "TOPIC[=ADDRESS]");
  add("--fix-in", &TopicChoice::fix,
      "Topic of PointStamped or PoseWithCovarianceStamped with the fixes; /tag:TYPE chooses (default: the "
      "only one)",
      "TOPIC[=ADDRESS][@PLACE]");
  const auto add_aiding = [&](ros2::AidingInput::Kind kind, const char* what) {
    app.add_option_function<std::vector<std::string>>(
           option_name(kind),
           [change, kind](const std::vector<std::string>& given) {
             change([&](TopicChoice& choice) { choice.aiding[kind] = given; });
           },
           what)
        .type_name("TOPIC[=ADDRESS]")
        .allow_extra_args(false)
        .group(group);
  };
  using Kind = ros2::AidingInput::Kind;
  add_aiding(Kind::odometry, "Topic of Odometry whose twist is the velocity (default: none)");
  add_aiding(Kind::twist, "Topic of TwistWithCovarianceStamped, or with :TwistStamped that (default: none)");
  add_aiding(Kind::wheels, "Topic of JointState with the wheels of --wheels (default: none)");
  app.add_option_function<std::string>(
         "--wheels",
         [change](const std::string& file) {
           change([&](TopicChoice& choice) { choice.wheels = ros2::read_wheels(file); });
         },
         "File with left_joints, right_joints, radius_m and track_m, for --wheel-in")
      .check(readable_by(ros2::read_wheels))
      .type_name("FILE")
      .group(group);
  add_aiding(Kind::heading,
             "Topic of Imu whose orientation is the heading, or with :PoseWithCovarianceStamped or :Float64 "
             "(degrees) that (default: none)");
  add_aiding(Kind::pose,
             "Topic of PoseWithCovarianceStamped, or with :PoseStamped or :Odometry that, with fixes and "
             "headings (default: none)");
  add_text(
      "--truth-in", [](TopicChoice& choice, const std::string& topic) { choice.truth = topic; },
      "Topic of Odometry, PoseStamped or PoseWithCovarianceStamped with the truth (default: none)", "TOPIC");
  add_text(
      "--base-frame", [](TopicChoice& choice, const std::string& frame) { choice.base_frame = frame; },
      "Frame of velocities, tags and truth; /tf_static says where the IMU is in it (default: base_link)",
      "FRAME");
  add_text(
      "--map-frame", [](TopicChoice& choice, const std::string& frame) { choice.map_frame = frame; },
      "Frame of the beacons' world, for fixes, headings and poses (default: map)", "FRAME");
  app.add_option_function<std::string>(
         "--imu-meaning",
         [change](const std::string& word) {
           change([&](TopicChoice& choice) {
             const auto at = std::ranges::find(imu_meaning_words, word) - imu_meaning_words.begin();
             choice.imu_meaning = static_cast<ImuMeaning>(at);
           });
         },
         "What the samples are: the value at their instant, or the mean since the previous one")
      .check(one_of(std::vector<std::string>(imu_meaning_words.begin(), imu_meaning_words.end())))
      .group(group);
}

}  // namespace sonopose::apps
