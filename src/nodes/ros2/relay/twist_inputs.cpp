#include "ros2/relay/twist_inputs.hpp"

#include "ros2/relay/input_option.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/twist_input.hpp>

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace sonopose::ros2::relay {

TwistInput TwistInput::parse_odometry(std::string_view text) {
  try {
    Input input = Input::parse(Input::Kind::imu, text);
    return {.type = Type::odometry, .topic = std::move(input.topic), .address = input.address};
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(fmt::format("--odom-in {}: expected TOPIC=ADDRESS; example: /odom=7", text));
  }
}

TwistInput TwistInput::parse_twist(std::string_view text) {
  TwistInput input;
  try {
    input = parse_odometry(text);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument(
        fmt::format("--twist-in {}: expected TOPIC[:TYPE]=ADDRESS; example: /wheel/twist=7", text));
  }
  input.type = Type::twist_with_covariance;
  const std::size_t colon = input.topic.find(':');
  if (colon == std::string::npos) return input;
  const std::string type = input.topic.substr(colon + 1);
  input.topic.resize(colon);
  if (type == "TwistStamped") {
    input.type = Type::twist;
  } else if (type != "TwistWithCovarianceStamped") {
    throw std::invalid_argument(
        fmt::format("--twist-in {}: '{}' is not TwistWithCovarianceStamped or TwistStamped", text, type));
  }
  return input;
}

void check(const std::vector<TwistInput>& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t j = i + 1; j < inputs.size(); ++j) {
      if (inputs[i].address != inputs[j].address) continue;
      throw std::invalid_argument(
          fmt::format("--odom-in and --twist-in: beacon {} can have only one source of "
                      "velocities, not {} and {}",
                      inputs[i].address, inputs[i].topic, inputs[j].topic));
    }
  }
}

class TwistInputs::Topic {
public:
  Topic() = default;
  Topic(const Topic&) = delete;
  Topic& operator=(const Topic&) = delete;
  virtual ~Topic() = default;
  virtual void attach_to(dds::WaitSet& waitset) = 0;
  virtual void take(publication::SampleSink& sink, const Reception& reception, const Log& log) = 0;
};

template <class T>
class TwistInputs::TopicOf final : public Topic {
public:
  TopicOf(ros2::Node& node, TwistInput input, const ros2::Mount& mount)
      : input_(std::move(input)),
        mount_(mount),
        reader_(node.make_reader<T>(input_.topic, "ros2::Input", nullptr, dds::StatusMask::none())),
        has_data_(reader_) {}

  void attach_to(dds::WaitSet& waitset) override { waitset += has_data_; }

  void take(publication::SampleSink& sink, const Reception& reception, const Log& log) override {
    reader_.try_take_each([&](const T& message, const dds::SampleInfo&) {
      if (const auto twist = ros2::twist_sample(message, input_.address, mount_, reception(input_.address))) {
        sink.on(*twist);
      } else if (!std::exchange(has_logged_, true)) {
        log(
            fmt::format("beacon {}: velocities on {} are not used: a value or stamp is invalid, no axis is "
                        "measured, or not all three are and the mount is oblique",
                        input_.address, input_.topic));
      }
    });
  }

private:
  TwistInput input_;
  ros2::Mount mount_;
  bool has_logged_ = false;
  dds::DataReader<T> reader_;
  dds::ReadCondition has_data_;
};

TwistInputs::TwistInputs(ros2::Node& node, const std::vector<TwistInput>& inputs, const ros2::Mount& mount) {
  for (const TwistInput& input : inputs) {
    switch (input.type) {
      case TwistInput::Type::odometry:
        topics_.push_back(std::make_unique<TopicOf<ros2::Odometry>>(node, input, mount));
        break;
      case TwistInput::Type::twist_with_covariance:
        topics_.push_back(std::make_unique<TopicOf<ros2::TwistWithCovarianceStamped>>(node, input, mount));
        break;
      case TwistInput::Type::twist:
        topics_.push_back(std::make_unique<TopicOf<ros2::TwistStamped>>(node, input, mount));
        break;
    }
  }
}

TwistInputs::~TwistInputs() = default;

void TwistInputs::attach_to(dds::WaitSet& waitset) {
  for (const auto& topic : topics_) topic->attach_to(waitset);
}

void TwistInputs::take(publication::SampleSink& sink, const Reception& reception, const Log& log) {
  for (const auto& topic : topics_) topic->take(sink, reception, log);
}

}  // namespace sonopose::ros2::relay
