#include "ros2/relay/twist_inputs.hpp"

#include "clocks/clocks.hpp"
#include "ros2/relay/input_option.hpp"
#include "ros2/relay/input_reader.hpp"
#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/twist_input.hpp>

#include <fmt/format.h>

#include <set>
#include <stdexcept>
#include <utility>

namespace sonopose::ros2::relay {
namespace {

/// Frame of the velocities.
const char* frame_of(const ros2::Odometry& odometry) {
  return odometry.child_frame_id;
}
template <class Twist>
const char* frame_of(const Twist& twist) {
  return twist.header.frame_id;
}

}  // namespace

TwistInput TwistInput::parse_odometry(std::string_view text) {
  TopicOfBeacon of = parse_topic("--odom-in", text, "/odom=7");
  return {.type = Type::odometry, .topic = std::move(of.topic), .address = of.address};
}

TwistInput TwistInput::parse_twist(std::string_view text) {
  TopicOfBeacon of = parse_topic("--twist-in", text, "/wheel/twist=7 or /wheel/twist:TwistStamped=7");
  TwistInput input{.type = Type::twist_with_covariance, .topic = std::move(of.topic), .address = of.address};
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
  Topic(const TwistInput& input, std::string dds_name, std::string type, TimeNs timeout_ns)
      : input_(input),
        topic_name_(std::move(dds_name)),
        type_(std::move(type)),
        monitor_({.kind = Input::Kind::twist, .topic = input.topic, .address = input.address}, {}, timeout_ns,
                 clocks::steady_now()) {}
  Topic(const Topic&) = delete;
  Topic& operator=(const Topic&) = delete;
  virtual ~Topic() = default;
  virtual void attach_to(dds::WaitSet& waitset) = 0;
  virtual void take(publication::SampleSink& sink, const Reception& reception, const MountSource& mount,
                    InputMonitor::Lines& lines) = 0;

  void update(SteadyTime now, InputMonitor::Lines& lines) {
    monitor_.update({.publishers = publishers(),
                     .publishers_incompatible = counters_.incompatible_qos.load(std::memory_order_relaxed),
                     .samples_lost = relay::samples_lost(counters_)},
                    now, lines);
  }

  void check_type(const dds::FoundEndpoint& writer, const Log& log) {
    const std::string& type = writer.type_name;
    if (writer.topic_name != topic_name_ || type == type_ || !other_types_.insert(type).second) return;
    log(logging::Level::warning,
        fmt::format("beacon {}: a publisher of {} is ignored, because its type is {}, not {}", input_.address,
                    input_.topic, ros2::type_name_in_ros(type), ros2::type_name_in_ros(type_)));
  }

  [[nodiscard]] std::uint64_t samples_lost(BeaconAddress address) const noexcept {
    return input_.address == address ? relay::samples_lost(counters_) : 0;
  }

protected:
  [[nodiscard]] virtual std::uint64_t publishers() = 0;

  const TwistInput input_;
  const std::string topic_name_;
  const std::string type_;
  std::set<std::string> other_types_;  ///< used by check_type() only
  process::EndpointCounters counters_;
  InputMonitor monitor_;
};

template <class T>
class TwistInputs::TopicOf final : public Topic {
public:
  TopicOf(ros2::Node& node, const TwistInput& input, TimeNs timeout_ns)
      : Topic(input, ros2::name_in_dds(node.names().topic(input.topic)),
              dds::TopicTraits<T>::descriptor().m_typename, timeout_ns),
        reader_(node, input.topic, counters_) {}

  void attach_to(dds::WaitSet& waitset) override { waitset += reader_.has_data; }

  void take(publication::SampleSink& sink, const Reception& reception, const MountSource& mount,
            InputMonitor::Lines& lines) override {
    reader_.reader.try_take_each([&](const T& message, const dds::SampleInfo&) {
      const BeaconAddress address = input_.address;
      if (const auto twist = ros2::twist_sample(message, address, mount(address), reception(address))) {
        monitor_.on_sample(frame_of(message), clocks::steady_now(), lines);
        sink.on(*twist);
      } else {
        monitor_.on_notice(InputMonitor::Notice::no_twist, {}, lines);
      }
    });
  }

private:
  [[nodiscard]] std::uint64_t publishers() override {
    return reader_.reader.subscription_matched_status().current_count;
  }

  InputReader<T> reader_;
};

TwistInputs::TwistInputs(ros2::Node& node, const std::vector<TwistInput>& inputs, MountSource mount,
                         TimeNs timeout_ns)
    : mount_(std::move(mount)) {
  for (const TwistInput& input : inputs) {
    switch (input.type) {
      case TwistInput::Type::odometry:
        topics_.push_back(std::make_unique<TopicOf<ros2::Odometry>>(node, input, timeout_ns));
        break;
      case TwistInput::Type::twist_with_covariance:
        topics_.push_back(
            std::make_unique<TopicOf<ros2::TwistWithCovarianceStamped>>(node, input, timeout_ns));
        break;
      case TwistInput::Type::twist:
        topics_.push_back(std::make_unique<TopicOf<ros2::TwistStamped>>(node, input, timeout_ns));
        break;
    }
  }
}

TwistInputs::~TwistInputs() = default;

void TwistInputs::attach_to(dds::WaitSet& waitset) {
  for (const auto& topic : topics_) topic->attach_to(waitset);
}

void TwistInputs::take(publication::SampleSink& sink, const Reception& reception,
                       InputMonitor::Lines& lines) {
  for (const auto& topic : topics_) topic->take(sink, reception, mount_, lines);
}

void TwistInputs::update(SteadyTime now, InputMonitor::Lines& lines) {
  for (const auto& topic : topics_) topic->update(now, lines);
}

void TwistInputs::check_type(const dds::FoundEndpoint& writer, const Log& log) {
  for (const auto& topic : topics_) topic->check_type(writer, log);
}

std::uint64_t TwistInputs::samples_lost(BeaconAddress address) const noexcept {
  std::uint64_t lost = 0;
  for (const auto& topic : topics_) lost += topic->samples_lost(address);
  return lost;
}

}  // namespace sonopose::ros2::relay
