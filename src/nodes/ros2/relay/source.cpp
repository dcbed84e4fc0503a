#include "ros2/relay/source.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "ros2/inputs/beacon_inputs.hpp"
#include "ros2/relay/input_reader.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/names.hpp>
#include <sonopose/ros2/messages/time.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <map>
#include <set>

namespace sonopose::ros2::relay {
namespace {

/// One input topic. The type in `option` is set by update_readers(), on its thread only.
struct InputState : MonitoredInput {
  InputState(const Input& input, const InputTimeouts& timeouts, const std::string& map_frame)
      : MonitoredInput(input, ros2::for_beacon(map_frame, input.address),
                       input.kind == Input::Kind::imu ? timeouts.imu_ns : timeouts.fix_ns,
                       clocks::steady_now()),
        is_imu(input.kind == Input::Kind::imu) {}

  bool is_imu;
  std::set<std::string> other_types;  ///< other types of publishers that were logged by update_readers()
  process::EndpointCounters endpoints;
};

/// The reader of an input.
template <class T>
struct Stream : InputReader<T> {
  Stream(ros2::Node& node, const std::string& topic, InputState& state)
      : InputReader<T>(node, topic, state.endpoints), input(state) {}

  InputState& input;
};

class TopicsSource final : public Source {
public:
  TopicsSource(ros2::Node& node, const std::vector<Input>& inputs, const InputTimeouts& timeouts,
               const std::string& map_frame, LineLogger log, TimeSource now)
      : log_(std::move(log)), now_(std::move(now)), node_(node), discovery_(node.participant()) {
    for (const Input& option : inputs) {
      InputState& input = *inputs_.emplace_back(std::make_unique<InputState>(option, timeouts, map_frame));
      Beacon& beacon = beacons_[option.address];
      beacon.status.address = option.address;
      beacon.inputs.add(option);
      if (input.is_imu || option.fix_type) subscribe(input);
    }
  }

  void use(std::unique_ptr<AidingInputs> aiding) override { aiding_ = std::move(aiding); }
  void use(InputFrames frames) override { frames_ = std::move(frames); }

  void log_changes() override {
    InputMonitor::Lines lines;
    std::uint64_t dropped = 0;
    {
      const threads::Lock lock(mutex_);
      lines.swap(new_lines_);
      std::swap(dropped, lines_dropped_);
    }
    for (const InputMonitor::Line& line : lines) log_(line.level, line.text());
    if (dropped == 0) return;
    log_(logging::Level::warning, fmt::format("{} not logged: too many at a time",
                                              text::count_text(dropped, "further line about the inputs was",
                                                               "further lines about the inputs were")));
  }

  SteadyTime update_readers() override {
    const SteadyTime now = clocks::steady_now();
    if (now < search_due_) return search_due_;
    for (const dds::FoundEndpoint& writer : discovery_.writers()) {
      for (const auto& input : inputs_) {
        if (writer.topic_name == ros2::name_in_dds(node_.names().topic(input->option.topic))) {
          on_writer(writer.type_name, *input);
        }
      }
      if (aiding_) aiding_->check_type(writer, log_);
    }
    const bool all_subscribed = std::all_of(inputs_.begin(), inputs_.end(), [](const auto& input) {
      return input->is_imu || input->option.fix_type;
    });
    search_due_ = now + (all_subscribed ? TimeNs{1'000'000'000} : TimeNs{100'000'000});
    return search_due_;
  }

  void run(publication::SampleSink& sink, const process::StopSignal& stop) override {
    constexpr std::chrono::milliseconds poll_period{100};
    if (aiding_) aiding_->attach_to(waitset_);
    while (!stop.requested()) {
      dds::ext::wait(waitset_, poll_period);
      add_new_streams();
      for_all_streams([&](auto& stream) { take(stream, sink); });
      for (auto& entry : beacons_) {
        entry.second.inputs.update(clocks::steady_now(), ready_, lines_);
        pass_ready(sink);
      }
      take_aiding(sink);
      check_inputs();
      publish_statuses(sink);
      sink.tick();
    }
  }

  std::uint64_t samples_lost(BeaconAddress address) const noexcept override {
    std::uint64_t lost = aiding_ ? aiding_->samples_lost(address) : 0;
    for (const auto& input : inputs_) {
      if (input->option.address == address) lost += relay::samples_lost(input->endpoints);
    }
    return lost;
  }

private:
  static constexpr std::size_t max_lines = 256;  ///< limit of the lines that wait for log_changes()

  template <class T>
  using Streams = std::vector<std::unique_ptr<Stream<T>>>;

  struct Beacon {
    BeaconStatus status;
    BeaconInputs inputs;
  };

  struct AllStreams {
    Streams<ros2::Imu> imus;
    Streams<ros2::SensorCombined> px4_imus;
    Streams<ros2::PointStamped> points;
    Streams<ros2::PoseWithCovarianceStamped> poses;
  };

  void on_writer(const std::string& type, InputState& input) {
    if (!input.is_imu && !input.option.fix_type) {
      input.option.fix_type = fix_type_named(type);
      if (input.option.fix_type) subscribe(input);
    }
    const std::string used = message_type_of(input.option);
    if (type == used || !input.other_types.insert(type).second) return;
    log_(
        logging::Level::warning,
        fmt::format("beacon {}: a publisher of {} is ignored, because its type is {}, not {}{}",
                    input.option.address, input.option.topic, ros2::type_name_in_ros(type),
                    used.empty() ? "PointStamped or PoseWithCovarianceStamped" : ros2::type_name_in_ros(used),
                    input.is_imu ? "" : advice_on_type(input.option.topic, ros2::type_name_in_ros(type))));
  }

  void subscribe(InputState& input) {
    if (input.is_imu && input.option.imu_type == ImuType::px4) {
      subscribe(&AllStreams::px4_imus, input);
    } else if (input.is_imu) {
      subscribe(&AllStreams::imus, input);
    } else if (input.option.fix_type == FixType::point) {
      subscribe(&AllStreams::points, input);
    } else {
      subscribe(&AllStreams::poses, input);
    }
  }

  template <class T>
  void subscribe(Streams<T> AllStreams::*streams, InputState& input) {
    auto created = std::make_unique<Stream<T>>(node_, input.option.topic, input);
    waitset_ += created->has_data;
    const threads::Lock lock(mutex_);
    (new_streams_.*streams).push_back(std::move(created));
  }

  void add_new_streams() {
    const auto move = [](auto& from, auto& to) {
      std::move(from.begin(), from.end(), std::back_inserter(to));
      from.clear();
    };
    const threads::Lock lock(mutex_);
    move(new_streams_.imus, streams_.imus);
    move(new_streams_.px4_imus, streams_.px4_imus);
    move(new_streams_.points, streams_.points);
    move(new_streams_.poses, streams_.poses);
  }

  template <class Action>
  void for_all_streams(const Action& action) {
    for (const auto& stream : streams_.imus) action(*stream);
    for (const auto& stream : streams_.px4_imus) action(*stream);
    for (const auto& stream : streams_.points) action(*stream);
    for (const auto& stream : streams_.poses) action(*stream);
  }

  template <class T>
  void take(Stream<T>& stream, publication::SampleSink& sink) {
    InputState& input = stream.input;
    Beacon& beacon = beacons_.at(input.option.address);
    dds::ext::try_take_each(stream.reader, [&](const T& message, const dds::sub::SampleInfo& info) {
      const BeaconInputs::Moment moment{next_reception_ns(), clocks::steady_now(),
                                        info.publication_handle().c_value()};
      ++beacon.status.frames;
      if (!process(message, input, beacon, moment, sink)) ++beacon.status.samples_rejected;
    });
  }

  bool process(const ros2::Imu& message, InputState& input, Beacon& beacon, BeaconInputs::Moment moment,
               publication::SampleSink& sink) {
    return process_imu(message, input, beacon, moment, sink);
  }
  bool process(const ros2::SensorCombined& message, InputState& input, Beacon& beacon,
               BeaconInputs::Moment moment, publication::SampleSink& sink) {
    return process_imu(message, input, beacon, moment, sink);
  }

  /// Processes a message of an IMU. Returns false if it is invalid.
  template <class Message>
  bool process_imu(const Message& message, InputState& input, Beacon& beacon, BeaconInputs::Moment moment,
                   publication::SampleSink& sink) {
    const bool is_valid = beacon.inputs.on(message, input, moment, ready_, lines_);
    pass_ready(sink);
    return is_valid;
  }

  /// Processes a message with a position. Returns false if it is invalid.
  template <class Position>
  bool process(const Position& message, InputState& input, Beacon& beacon, BeaconInputs::Moment moment,
               publication::SampleSink& sink) {
    const auto taken = beacon.inputs.on(message, input, moment, frames_, lines_);
    if (taken.fix) sink.on(*taken.fix);
    return taken.is_valid;
  }

  /// Passes on the samples that are complete.
  void pass_ready(publication::SampleSink& sink) {
    for (const ImuSample& sample : ready_) sink.on(sample);
    ready_.clear();
  }

  void take_aiding(publication::SampleSink& sink) {
    if (!aiding_) return;
    aiding_->take(
        sink,
        [this](const AidingInput& input) {
          const TimeNs time_ns = now_();
          const auto beacon = beacons_.find(input.address);
          return AidingInputs::Received{
              time_ns, beacon == beacons_.end() ? time_ns : beacon->second.inputs.stamp_at(time_ns)};
        },
        lines_);
  }

  /// Time of ROS 2, later than the previous one: the stamp of messages without a stamp.
  TimeNs next_reception_ns() {
    const TimeNs time_ns = now_();
    return reception_.next(time_ns).value_or(time_ns);
  }

  void check_inputs() {
    constexpr TimeNs period_ns = 20'000'000;
    const SteadyTime now = clocks::steady_now();
    if (now >= check_due_) {
      check_due_ = now + period_ns;
      for (const auto& input : inputs_) {
        input->monitor.update(endpoints_of(*input), now, lines_);
        if (!input->is_imu) beacons_.at(input->option.address).inputs.check_clocks(*input, now, lines_);
      }
      if (aiding_) {
        aiding_->update(now, lines_, [this, now](MonitoredInput& input) {
          const auto beacon = beacons_.find(input.option.address);
          if (beacon != beacons_.end()) beacon->second.inputs.check_clocks(input, now, lines_);
        });
      }
    }
    if (lines_.empty()) return;
    const threads::Lock lock(mutex_);
    for (InputMonitor::Line& line : lines_) {
      if (new_lines_.size() < max_lines) {
        new_lines_.push_back(std::move(line));
      } else {
        ++lines_dropped_;
      }
    }
    lines_.clear();
  }

  InputEndpoints endpoints_of(const InputState& input) {
    InputEndpoints endpoints;
    for_all_streams([&](auto& stream) {
      if (&stream.input == &input) endpoints.publishers += relay::publishers_of(stream.reader);
    });
    endpoints.publishers_incompatible = input.endpoints.incompatible_qos.load(std::memory_order_relaxed);
    endpoints.samples_lost = relay::samples_lost(input.endpoints);
    return endpoints;
  }

  void publish_statuses(publication::SampleSink& sink) {
    constexpr TimeNs period_ns = 250'000'000;
    if (clocks::steady_now() < statuses_due_) return;
    statuses_due_ = clocks::steady_now() + period_ns;
    for (auto& [address, beacon] : beacons_) {
      if (beacon.status.frames == 0) continue;
      beacon.status.time_ns = clocks::host_now();
      beacon.status.clock_offset_s = beacon.inputs.offset_s();
      BeaconStatus status = beacon.status;
      status.samples_rejected += beacon.inputs.dropped();
      if (aiding_) status.samples_rejected += aiding_->unused(address);
      sink.on(status);
    }
  }

  LineLogger log_;
  TimeSource now_;
  ros2::Node& node_;                                 ///< used on the thread of update_readers() only
  dds::Discovery discovery_;                         ///< likewise
  SteadyTime search_due_;                            ///< likewise
  std::vector<std::unique_ptr<InputState>> inputs_;  ///< constant after construction
  threads::Mutex mutex_;
  AllStreams new_streams_ SONOPOSE_GUARDED_BY(mutex_);           ///< not yet used by run()
  InputMonitor::Lines new_lines_ SONOPOSE_GUARDED_BY(mutex_);    ///< not yet formatted
  std::uint64_t lines_dropped_ SONOPOSE_GUARDED_BY(mutex_) = 0;  ///< dropped since the last log_changes()
  AllStreams streams_;                                           ///< used by run() only
  std::unique_ptr<AidingInputs> aiding_;                         ///< null: none
  dds::core::cond::WaitSet waitset_;  ///< after the readers, which its conditions keep
  InputFrames frames_;
  std::map<BeaconAddress, Beacon> beacons_;
  std::vector<ImuSample> ready_;  ///< used by run() only
  ros2::RisingStamp reception_;
  InputMonitor::Lines lines_;  ///< used by run() only, like the next ones
  SteadyTime check_due_;
  SteadyTime statuses_due_;
};

}  // namespace

std::unique_ptr<Source> make_source(ros2::Node& node, const std::vector<Input>& inputs,
                                    const InputTimeouts& timeouts, const std::string& map_frame,
                                    LineLogger log, TimeSource now) {
  check(inputs);
  if (!log) log = logging::write;
  return std::make_unique<TopicsSource>(node, inputs, timeouts, map_frame, std::move(log), std::move(now));
}

}  // namespace sonopose::ros2::relay
