#include "ros2/relay/aiding_inputs.hpp"

#include "clocks/clocks.hpp"
#include "ros2/inputs/aiding_samples.hpp"
#include "ros2/relay/input_reader.hpp"
#include "threads/mutex.hpp"
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/service_types.hpp>

#include <fmt/format.h>

#include <optional>
#include <set>
#include <utility>

namespace sonopose::ros2::relay {

class AidingInputs::Topic {
public:
  Topic(const AidingInput& input, std::string dds_name, std::string type, TimeNs timeout_ns)
      : input_(input),
        topic_name_(std::move(dds_name)),
        type_(std::move(type)),
        monitored_(monitored_as(input), {}, timeout_ns, clocks::steady_now()) {}
  Topic(const Topic&) = delete;
  Topic& operator=(const Topic&) = delete;
  virtual ~Topic() = default;
  /// Takes a request of its service, on any thread.
  virtual void take_request(const ros2::PoseWithCovarianceStamped& /*pose*/) {}
  [[nodiscard]] const AidingInput& input() const { return input_; }
  virtual void attach_to(dds::core::cond::WaitSet& waitset) = 0;
  virtual void take(publication::SampleSink& sink, const Reception& reception, const InputFrames& frames,
                    InputMonitor::Lines& lines) = 0;

  void update(SteadyTime now, InputMonitor::Lines& lines,
              const std::function<void(MonitoredInput& input)>& check) {
    if (input_.kind == AidingInput::Kind::set_pose) return;  // comes when the user wants
    if (check) check(monitored_);
    monitored_.monitor.update(
        {.publishers = publishers(),
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

  [[nodiscard]] std::uint64_t unused(BeaconAddress address) const {
    return input_.address == address ? unused_ : 0;
  }

  [[nodiscard]] std::uint64_t samples_lost(BeaconAddress address) const noexcept {
    return input_.address == address ? relay::samples_lost(counters_) : 0;
  }

protected:
  [[nodiscard]] virtual std::uint64_t publishers() = 0;

  /// Passes on the samples of a message, and says what is not used. Returns false if nothing is.
  bool pass(const AidingSamples& samples, BeaconInputs::Moment moment, publication::SampleSink& sink,
            InputMonitor::Lines& lines) {
    const auto measured_ns = samples.measured_ns();
    if (measured_ns) {
      monitored_.monitor.on_sample({}, moment.now, lines);
      BeaconInputs::note_stamp(*measured_ns, monitored_, moment);
      if (input_.kind != AidingInput::Kind::set_pose)
        BeaconInputs::notice_publisher(monitored_, moment, lines);
    } else {
      ++unused_;
    }
    if (input_.kind == AidingInput::Kind::set_pose) {
      lines.push_back(set_pose_line(input_, samples));
    } else if (!samples.unused.empty()) {
      monitored_.monitor.on_unused(samples.unused, lines);
    }
    if (samples.twist) sink.on(*samples.twist);
    if (samples.heading) sink.on(*samples.heading);
    if (samples.fix) sink.on(*samples.fix);
    return measured_ns.has_value();
  }

  const AidingInput input_;
  const std::string topic_name_;
  const std::string type_;
  std::set<std::string> other_types_;  ///< used by check_type() only
  process::EndpointCounters counters_;
  MonitoredInput monitored_;
  std::uint64_t unused_ = 0;
};

template <class T>
class AidingInputs::TopicOf final : public Topic {
public:
  TopicOf(ros2::Node& node, const AidingInput& input, TimeNs timeout_ns)
      : Topic(input, ros2::name_in_dds(node.names().topic(input.topic)),
              dds::TopicTraits<T>::descriptor().m_typename, timeout_ns),
        reader_(node, input.topic, counters_) {}

  void attach_to(dds::core::cond::WaitSet& waitset) override { waitset += reader_.has_data; }

  void take(publication::SampleSink& sink, const Reception& reception, const InputFrames& frames,
            InputMonitor::Lines& lines) override {
    dds::ext::try_take_each(reader_.reader, [&](const T& message, const dds::sub::SampleInfo& info) {
      const Received received = reception(input_);
      const bool is_used =
          pass(samples_of(message, input_, frames, received.in_stamps_ns),
               {received.time_ns, clocks::steady_now(), info.publication_handle().c_value()}, sink, lines);
      if constexpr (requires { message.header; }) {
        if (is_used && input_.kind != AidingInput::Kind::set_pose)
          BeaconInputs::notice_stamp(message.header, monitored_, lines);
      }
    });
  }

private:
  [[nodiscard]] std::uint64_t publishers() override { return relay::publishers_of(reader_.reader); }

  InputReader<T> reader_;
};

/// Poses of a service, which another thread receives.
class AidingInputs::SetPoses final : public Topic {
public:
  explicit SetPoses(const AidingInput& input)
      : Topic(input, {}, dds::TopicTraits<ros2::SetPose::Request>::descriptor().m_typename, 0) {}

  void attach_to(dds::core::cond::WaitSet& /*waitset*/) override {
  }  // polled, since another thread receives them

  void take_request(const ros2::PoseWithCovarianceStamped& pose) override {
    const threads::Lock lock(mutex_);
    latest_ = {pose, pose.header.frame_id == nullptr ? "" : pose.header.frame_id};
  }

  void take(publication::SampleSink& sink, const Reception& reception, const InputFrames& frames,
            InputMonitor::Lines& lines) override {
    std::optional<Request> request;
    {
      const threads::Lock lock(mutex_);
      latest_.swap(request);
    }
    if (!request) return;
    request->pose.header.frame_id = request->frame.data();
    const Received received = reception(input_);
    pass(samples_of(request->pose, input_, frames, received.in_stamps_ns),
         {received.time_ns, clocks::steady_now(), 0}, sink, lines);
  }

private:
  struct Request {
    ros2::PoseWithCovarianceStamped pose{};
    std::string frame;  ///< that of `pose`
  };

  [[nodiscard]] std::uint64_t publishers() override { return 0; }

  threads::Mutex mutex_;
  std::optional<Request> latest_ SONOPOSE_GUARDED_BY(mutex_);
};

AidingInputs::AidingInputs(ros2::Node& node, const std::vector<AidingInput>& inputs, InputFrames frames,
                           TimeNs timeout_ns)
    : frames_(std::move(frames)) {
  for (const AidingInput& input : inputs) {
    const auto add = [&]<class T>(std::type_identity<T> /*type*/) {
      topics_.push_back(std::make_unique<TopicOf<T>>(node, input, timeout_ns));
    };
    switch (input.type) {
      case AidingInput::Type::odometry:
        add(std::type_identity<ros2::Odometry>{});
        break;
      case AidingInput::Type::twist_with_covariance:
        add(std::type_identity<ros2::TwistWithCovarianceStamped>{});
        break;
      case AidingInput::Type::twist:
        add(std::type_identity<ros2::TwistStamped>{});
        break;
      case AidingInput::Type::joints:
        add(std::type_identity<ros2::JointState>{});
        break;
      case AidingInput::Type::imu:
        add(std::type_identity<ros2::Imu>{});
        break;
      case AidingInput::Type::pose_with_covariance:
        add(std::type_identity<ros2::PoseWithCovarianceStamped>{});
        break;
      case AidingInput::Type::pose:
        add(std::type_identity<ros2::PoseStamped>{});
        break;
      case AidingInput::Type::degrees:
        add(std::type_identity<ros2::Float64>{});
        break;
      case AidingInput::Type::set_pose_service:
        topics_.push_back(std::make_unique<SetPoses>(input));
        break;
    }
  }
}

AidingInputs::~AidingInputs() = default;

std::vector<SetPoseService> AidingInputs::services() {
  std::vector<SetPoseService> services;
  for (const auto& topic : topics_) {
    if (topic->input().type != AidingInput::Type::set_pose_service) continue;
    services.push_back(
        {topic->input().topic, [topic = topic.get()](const auto& pose) { topic->take_request(pose); }});
  }
  return services;
}

void AidingInputs::attach_to(dds::core::cond::WaitSet& waitset) {
  for (const auto& topic : topics_) topic->attach_to(waitset);
}

void AidingInputs::take(publication::SampleSink& sink, const Reception& reception,
                        InputMonitor::Lines& lines) {
  for (const auto& topic : topics_) topic->take(sink, reception, frames_, lines);
}

void AidingInputs::update(SteadyTime now, InputMonitor::Lines& lines,
                          const std::function<void(MonitoredInput& input)>& check) {
  for (const auto& topic : topics_) topic->update(now, lines, check);
}

void AidingInputs::check_type(const dds::FoundEndpoint& writer, const Log& log) {
  for (const auto& topic : topics_) topic->check_type(writer, log);
}

std::uint64_t AidingInputs::unused(BeaconAddress address) const {
  std::uint64_t count = 0;
  for (const auto& topic : topics_) count += topic->unused(address);
  return count;
}

std::uint64_t AidingInputs::samples_lost(BeaconAddress address) const noexcept {
  std::uint64_t lost = 0;
  for (const auto& topic : topics_) lost += topic->samples_lost(address);
  return lost;
}

}  // namespace sonopose::ros2::relay
