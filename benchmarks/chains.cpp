#include "chains.hpp"

#include "bare_chain.hpp"
#include "clocks/clocks.hpp"
#include "own_realtime.hpp"
#include "plain_chain.hpp"
#include "ros2_latency.hpp"
#include <sonopose/dds/topics/topics.hpp>

#include <fmt/format.h>

#include <mutex>
#include <optional>
#include <sched.h>
#include <stdexcept>
#include <thread>
#include <utility>

namespace sonopose::benchmarks {
namespace {

constexpr TimeNs timeout_ns = 10'000'000'000;
constexpr TimeNs warm_up_ns = 500'000'000;

/// Collects the latency of each received pose.
class LatencyCollector {
public:
  void on(const sonopose_FusedPose& pose, TimeNs received_ns) {
    const std::lock_guard lock(mutex_);
    latencies_.push_back({seconds_between(pose.imu_bridge_time, pose.fusion_in_time),
                          seconds_between(pose.fusion_in_time, pose.fusion_out_time),
                          seconds_between(pose.fusion_out_time, received_ns)});
  }
  std::vector<Latency> taken() {
    const std::lock_guard lock(mutex_);
    return std::exchange(latencies_, {});
  }

private:
  std::mutex mutex_;
  std::vector<Latency> latencies_;
};

class PoseListener final : public dds::sub::NoOpDataReaderListener<sonopose_FusedPose> {
public:
  explicit PoseListener(LatencyCollector& latencies) : latencies_(latencies) {}
  void on_data_available(dds::sub::DataReader<sonopose_FusedPose>& reader) noexcept override {
    const TimeNs received_ns = clocks::host_now();
    dds::ext::try_take_each(reader, [&](const sonopose_FusedPose& pose, const dds::sub::SampleInfo&) {
      latencies_.on(pose, received_ns);
    });
  }

private:
  LatencyCollector& latencies_;
};

void sleep_ns(TimeNs duration_ns) {
  std::this_thread::sleep_for(std::chrono::nanoseconds(duration_ns));
}

/// Waits for the first poses and a warm-up, then measures.
template <class LatencyCollector>
Round measure(const RoundOptions& options, const Child& relay, LatencyCollector& latencies) {
  const SteadyTime give_up = clocks::steady_now() + timeout_ns;
  while (latencies.taken().empty() && clocks::steady_now() < give_up) sleep_ns(20'000'000);
  sleep_ns(warm_up_ns);
  const std::int64_t cpu_before_ns = relay.cpu_time_ns();
  latencies.taken();
  sleep_ns(to_ns(options.length_s));
  Round round;
  round.latencies = latencies.taken();
  if (round.latencies.empty()) throw std::runtime_error("no pose came through the chain");
  round.relay_cpu_s =
      seconds_between(cpu_before_ns, relay.cpu_time_ns()) / static_cast<double>(round.latencies.size());
  return round;
}

/// Measures with a ROS 2 process as the consumer.
Round measure_in_ros2(const RoundOptions& options, const Child& relay) {
  Ros2LatencyCollector latencies;
  const auto participant = dds::ext::participant({options.domain, dds::Network::loopback});
  const dds::qos::Provider qos;
  const auto native = dds::topics::make_reader(participant, qos, dds::topics::pose, &latencies);
  const dds::topic::Topic<ros2::Odometry> topic(participant, ros2::name_in_dds("/hedge_7/odom"));
  const dds::sub::DataReader<ros2::Odometry> reader(dds::sub::Subscriber(participant), topic,
                                                    qos.datareader_qos("ros2::Default"), &latencies);
  return measure(options, relay, latencies);
}

Round measure_on_bus(const RoundOptions& options, const Child& relay, bool realtime = false) {
  LatencyCollector latencies;
  PoseListener listener(latencies);
  const auto participant = dds::ext::participant({options.domain, dds::Network::loopback});
  const dds::qos::Provider qos;
  const auto reader = dds::topics::make_reader(participant, qos, dds::topics::pose, &listener);
  std::optional<OwnRealtime> own;
  if (realtime) own.emplace();
  return measure(options, relay, latencies);
}

// All rounds fork their children before this process has other threads.

Round plain_round(const RoundOptions& options) {
  LoopbackSocket source_out;
  LoopbackSocket relay_in;
  LoopbackSocket relay_out;
  LoopbackSocket consumer_in;
  source_out.connect(relay_in);
  relay_out.connect(consumer_in);
  const auto relay = Child::fork_to([&] { run_plain_relay(relay_in, relay_out); });
  const auto source = Child::fork_to([&] { run_plain_source(source_out, options.rate_hz); });
  LatencyCollector latencies;
  const std::jthread consumer([&](const std::stop_token& stop) {
    take_plain_poses(
        consumer_in, [&stop] { return stop.stop_requested(); },
        [&latencies](const sonopose_FusedPose& pose, TimeNs received_ns) {
          latencies.on(pose, received_ns);
        });
  });
  return measure(options, relay, latencies);
}

Round bare_round(const RoundOptions& options) {
  const auto relay = Child::fork_to([&] { run_bare_relay(options.domain); });
  const auto source = Child::fork_to([&] { run_bare_source(options.domain, options.rate_hz); });
  return measure_on_bus(options, relay);
}

void stay_on(unsigned cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  if (::sched_setaffinity(0, sizeof set, &set) != 0) throw std::runtime_error("sched_setaffinity failed");
}

/// Starts one idle-priority process per core.
std::vector<Child> keep_awake() {
  std::vector<Child> children;
  for (unsigned cpu = 0; cpu < std::thread::hardware_concurrency(); ++cpu) {
    children.push_back(Child::fork_to([cpu] {
      stay_on(cpu);
      const sched_param lowest{};
      if (::sched_setscheduler(0, SCHED_IDLE, &lowest) != 0) throw std::runtime_error("SCHED_IDLE refused");
      volatile unsigned counter = 0;
      while (true) counter = counter + 1;
    }));
  }
  return children;
}

Round real_round(const RoundOptions& options, const Tuning& tuning) {
  const std::vector<Child> awake = tuning.awake ? keep_awake() : std::vector<Child>{};
  std::vector<std::string> fusion{tuning.fusion.empty() ? SONOPOSE_FUSION : tuning.fusion, "--domain",
                                  std::to_string(options.domain)};
  std::vector<std::string> bridge{SONOPOSE_BRIDGE, "--domain", std::to_string(options.domain), "--imu-rate",
                                  fmt::format("{}", options.rate_hz)};
  if (!tuning.engine.empty()) fusion.insert(fusion.end(), {"--set", "fusion.engine=" + tuning.engine});
  if (tuning.realtime) {
    fusion.emplace_back("--realtime");
    bridge.emplace_back("--realtime");
  }
  const auto relay = Child::execute(fusion, [&tuning] {
    if (tuning.fusion_cpu) stay_on(*tuning.fusion_cpu);
  });
  const auto source = Child::execute(bridge);
  if (tuning.ros2) {
    const auto to_ros2 = Child::execute({SONOPOSE_ROS2, "--domain", std::to_string(options.domain)});
    return measure_in_ros2(options, to_ros2);
  }
  return measure_on_bus(options, relay, tuning.realtime);
}

}  // namespace

Chain plain_chain() {
  return {"udp", plain_round};
}

Chain bare_chain(std::string name) {
  return {std::move(name), bare_round};
}

Chain real_chain(std::string name, const Tuning& tuning) {
  return {std::move(name), [tuning](const RoundOptions& options) { return real_round(options, tuning); }};
}

}  // namespace sonopose::benchmarks
