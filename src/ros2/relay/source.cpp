#include "ros2/relay/source.hpp"

#include "process/clocks.hpp"
#include "process/endpoint_counters.hpp"
#include "ros2/relay/input_detector.hpp"
#include <sonopose/dds/binding/waitset.hpp>
#include <sonopose/ros2/messages/frames.hpp>
#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>

namespace sonopose::ros2 {
namespace {

/// What a listener counts. The news of data stays with the wait set, matches are asked for.
constexpr dds::StatusMask counted_statuses = dds::StatusMask::requested_incompatible_qos() |
                                             dds::StatusMask::sample_lost() |
                                             dds::StatusMask::sample_rejected();

/// One input: a topic, which has a reader for each type that it may be of.
struct Input {
  Input(const Ros2Input& what, const Ros2Timeouts& timeouts, const std::string& map_frame)
      : address(what.address),
        is_imu(what.kind == Ros2Input::Kind::imu),
        watch(what, ros2::for_beacon(map_frame, what.address), is_imu ? timeouts.imu_ns : timeouts.fix_ns,
              process::steady_now()) {}

  [[nodiscard]] std::uint64_t samples_lost() const noexcept {
    return ends.samples_lost.load(std::memory_order_relaxed) +
           ends.samples_rejected.load(std::memory_order_relaxed);
  }

  BeaconAddress address;
  bool is_imu;
  process::EndpointCounters ends;
  Ros2InputDetector watch;
};

/// The reader of one of an input's types.
template <class T>
struct Stream {
  Stream(ros2::Node& node, const std::string& topic, Input& its_input)
      : input(its_input),
        listener(its_input.ends),
        reader(node.make_reader<T>(topic, "ros2::Input", &listener, counted_statuses)),
        news(reader) {}

  Input& input;
  process::CountingReaderListener<T> listener;
  dds::DataReader<T> reader;
  dds::ReadCondition news;
};

std::optional<Event> event_of(const ros2::Imu& imu, BeaconAddress address, TimeNs received_ns) {
  return ros2::imu_sample(imu, address, received_ns);
}
template <class Position>
std::optional<Event> event_of(const Position& position, BeaconAddress address, TimeNs received_ns) {
  return ros2::fix(position, address, received_ns);
}

/// When it was measured, by its sender's clock.
TimeNs measured_ns(const Event& event) {
  if (const auto* imu = std::get_if<ImuSample>(&event)) return imu->sensor_time_ns;
  if (const auto* fix = std::get_if<UltrasonicFix>(&event)) return fix->emission_time_ns;
  return std::get<PairHeading>(event).emission_time_ns;
}

void tell_on_standard_error(const std::string& line) {
  fmt::print(stderr, "sonopose-ros2: {}\n", line);
}

class TopicsSource final : public Ros2Source {
public:
  TopicsSource(ros2::Node& node, const std::vector<Ros2Input>& inputs, const Ros2Timeouts& timeouts,
               const std::string& map_frame, Ros2Teller tell)
      : tell_(std::move(tell)) {
    for (const Ros2Input& what : inputs) {
      Input& input = *inputs_.emplace_back(std::make_unique<Input>(what, timeouts, map_frame));
      Beacon& beacon = beacons_[what.address];
      beacon.status.address = what.address;
      beacon.has_imu = beacon.has_imu || input.is_imu;
      if (input.is_imu) {
        listen(imus_, node, what.topic, input);
      } else {
        listen(points_, node, what.topic, input);
        listen(poses_, node, what.topic, input);
      }
    }
  }

  void run(bridge::SampleSink& sink, const process::StopSignal& stop) override {
    constexpr std::chrono::milliseconds longest_sleep{100};
    while (!stop.requested()) {
      waitset_.wait(longest_sleep);
      for_all_streams([&](auto& stream) { take(stream, sink); });
      check_inputs();
      log_statuses(sink);
      sink.tick();
    }
  }

  std::uint64_t samples_lost(BeaconAddress address) const noexcept override {
    std::uint64_t lost = 0;
    for (const auto& input : inputs_) {
      if (input->address == address) lost += input->samples_lost();
    }
    return lost;
  }

private:
  template <class T>
  using Streams = std::vector<std::unique_ptr<Stream<T>>>;

  struct Beacon {
    BeaconStatus status;
    bool has_imu = false;
    SmallestOffset offset;  ///< of the IMU's samples, where there is an IMU
  };

  template <class T>
  void listen(Streams<T>& streams, ros2::Node& node, const std::string& topic, Input& input) {
    streams.push_back(std::make_unique<Stream<T>>(node, topic, input));
    waitset_ += streams.back()->news;
  }

  template <class Action>
  void for_all_streams(const Action& action) {
    for (const auto& stream : imus_) action(*stream);
    for (const auto& stream : points_) action(*stream);
    for (const auto& stream : poses_) action(*stream);
  }

  template <class T>
  void take(Stream<T>& stream, bridge::SampleSink& sink) {
    Input& input = stream.input;
    Beacon& beacon = beacons_.at(input.address);
    stream.reader.try_take_each([&](const T& message, const dds::SampleInfo&) {
      const TimeNs received_ns = next_reception_ns();
      ++beacon.status.frames;
      const auto event = event_of(message, input.address, received_ns);
      if (!event) {
        ++beacon.status.samples_rejected;
        return;
      }
      const SteadyTime now = process::steady_now();
      if (input.is_imu == beacon.has_imu) {
        beacon.offset.add(seconds_between(measured_ns(*event), received_ns), now);
      }
      input.watch.on_sample(message.header.frame_id, now, lines_);
      sink.on(*event);
    });
  }

  /// Now, by the host's clock, but later than the one before: messages without a stamp have this one.
  TimeNs next_reception_ns() {
    const TimeNs time_ns = process::host_now();
    return reception_.next(time_ns).value_or(time_ns);
  }

  void check_inputs() {
    constexpr TimeNs period_ns = 20'000'000;
    const SteadyTime now = process::steady_now();
    if (now >= look_due_) {
      look_due_ = now + period_ns;
      for (const auto& input : inputs_) input->watch.look(ends_of(*input), now, lines_);
    }
    for (const std::string& line : lines_) tell_(line);
    lines_.clear();
  }

  Ros2InputEnds ends_of(const Input& input) {
    Ros2InputEnds ends;
    for_all_streams([&](auto& stream) {
      if (&stream.input == &input)
        ends.publishers += stream.reader.subscription_matched_status().current_count;
    });
    ends.publishers_refused = input.ends.incompatible_qos.load(std::memory_order_relaxed);
    ends.samples_lost = input.samples_lost();
    return ends;
  }

  void log_statuses(bridge::SampleSink& sink) {
    constexpr TimeNs period_ns = 250'000'000;
    if (process::steady_now() < statuses_due_) return;
    statuses_due_ = process::steady_now() + period_ns;
    for (auto& [address, beacon] : beacons_) {
      if (beacon.status.frames == 0) continue;
      beacon.status.time_ns = process::host_now();
      beacon.status.clock_offset_s = beacon.offset.value_s();
      sink.on(beacon.status);
    }
  }

  Ros2Teller tell_;
  std::vector<std::unique_ptr<Input>> inputs_;  ///< as many as there were at the start
  Streams<ros2::Imu> imus_;
  Streams<ros2::PointStamped> points_;
  Streams<ros2::PoseWithCovarianceStamped> poses_;
  dds::WaitSet waitset_;
  std::map<BeaconAddress, Beacon> beacons_;
  ros2::RisingStamp reception_;
  Ros2InputDetector::Lines lines_;
  SteadyTime look_due_;
  SteadyTime statuses_due_;
};

}  // namespace

std::unique_ptr<Ros2Source> make_ros2_source(ros2::Node& node, const std::vector<Ros2Input>& inputs,
                                             const Ros2Timeouts& timeouts, const std::string& map_frame,
                                             Ros2Teller tell) {
  check(inputs);
  if (!tell) tell = tell_on_standard_error;
  return std::make_unique<TopicsSource>(node, inputs, timeouts, map_frame, std::move(tell));
}

}  // namespace sonopose::ros2
