#include <sonopose/dds/waitset.hpp>
#include <sonopose/nodes/host_clock.hpp>
#include <sonopose/nodes/ros2_source.hpp>
#include <sonopose/nodes/silence_watch.hpp>
#include <sonopose/ros2/input.hpp>

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cstdio>
#include <map>
#include <stdexcept>

namespace sonopose::nodes {
namespace {

const char* word(Ros2Input::Kind kind) {
  return kind == Ros2Input::Kind::imu ? "--imu-in" : "--fix-in";
}

/// One topic of one type.
template <class T>
struct Stream {
  Stream(ros2::Node& node, const Ros2Input& input)
      : address(input.address), reader(node.make_reader<T>(input.topic, "ros2::SensorData")), news(reader) {}

  BeaconAddress address;
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

/// Tells what of one kind has fallen silent, and what is heard again.
void tell(SilenceWatch& watch, const char* kind, std::vector<SilenceWatch::Change>& changes) {
  changes.clear();
  watch.find_changes(steady_now_ns(), changes);
  for (const auto& change : changes) {
    if (change.silent) {
      fmt::print(stderr, "sonopose-ros2: beacon {}: no {} from ROS 2 for {:.1f} s\n", change.address, kind,
                 change.lasted_s);
    } else {
      fmt::print(stderr, "sonopose-ros2: beacon {}: {} from ROS 2 again, after {:.1f} s\n", change.address,
                 kind, change.lasted_s);
    }
  }
}

class Ros2Source final : public Source {
public:
  Ros2Source(ros2::Node& node, const std::vector<Ros2Input>& inputs, const Ros2Timeouts& timeouts)
      : imu_silences_(timeouts.imu_ns), fix_silences_(timeouts.fix_ns) {
    for (const Ros2Input& input : inputs) {
      statuses_[input.address].address = input.address;
      if (input.kind == Ros2Input::Kind::imu) {
        listen(imus_, node, input);
      } else {
        listen(points_, node, input);
        listen(poses_, node, input);
      }
    }
  }

  void run(SampleSink& sink, const StopSignal& stop) override {
    constexpr std::chrono::milliseconds longest_sleep{100};
    while (!stop.requested()) {
      waitset_.wait(longest_sleep);
      take(imus_, imu_silences_, sink);
      take(points_, fix_silences_, sink);
      take(poses_, fix_silences_, sink);
      tell(imu_silences_, "IMU samples", changes_);
      tell(fix_silences_, "fixes", changes_);
      tell_statuses(sink);
      sink.tick();
    }
  }

private:
  template <class T>
  using Streams = std::vector<std::unique_ptr<Stream<T>>>;

  template <class T>
  void listen(Streams<T>& streams, ros2::Node& node, const Ros2Input& input) {
    streams.push_back(std::make_unique<Stream<T>>(node, input));
    waitset_ += streams.back()->news;
  }

  template <class T>
  void take(Streams<T>& streams, SilenceWatch& silences, SampleSink& sink) {
    for (const auto& stream : streams) {
      const TimeNs received_ns = now_ns();
      stream->reader.try_take_each([&](const T& message, const dds::SampleInfo&) {
        BeaconStatus& status = statuses_[stream->address];
        ++status.frames;
        const auto event = event_of(message, stream->address, received_ns);
        if (!event) {
          ++status.samples_rejected;
          return;
        }
        status.clock_offset_s = seconds_between(measured_ns(*event), received_ns);
        silences.on_sample(stream->address, steady_now_ns());
        sink.on(*event);
      });
    }
  }

  void tell_statuses(SampleSink& sink) {
    constexpr TimeNs period_ns = 250'000'000;
    if (steady_now_ns() < statuses_due_ns_) return;
    statuses_due_ns_ = steady_now_ns() + period_ns;
    for (auto& [address, status] : statuses_) {
      if (status.frames == 0) continue;
      status.time_ns = now_ns();
      sink.on(status);
    }
  }

  Streams<ros2::Imu> imus_;
  Streams<ros2::PointStamped> points_;
  Streams<ros2::PoseWithCovarianceStamped> poses_;
  dds::WaitSet waitset_;
  SilenceWatch imu_silences_;
  SilenceWatch fix_silences_;
  std::vector<SilenceWatch::Change> changes_;
  std::map<BeaconAddress, BeaconStatus> statuses_;
  TimeNs statuses_due_ns_ = 0;
};

}  // namespace

Ros2Input Ros2Input::parse(Kind kind, std::string_view text) {
  const std::size_t equals = text.rfind('=');
  const auto fail = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{} {}: {}; as in /imu/data=7", word(kind), text, why));
  };
  if (equals == std::string_view::npos || equals == 0) fail("a topic, '=' and a beacon's address are needed");
  const std::string_view number = text.substr(equals + 1);
  std::uint32_t address = 0;
  const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), address);
  if (error != std::errc() || rest != number.data() + number.size() || address >= all_beacons) {
    fail(fmt::format("'{}' is no address of 0 to {}", number, all_beacons - 1));
  }
  return {kind, std::string(text.substr(0, equals)), static_cast<BeaconAddress>(address)};
}

std::unique_ptr<Source> make_ros2_source(ros2::Node& node, const std::vector<Ros2Input>& inputs,
                                         const Ros2Timeouts& timeouts) {
  return std::make_unique<Ros2Source>(node, inputs, timeouts);
}

}  // namespace sonopose::nodes
