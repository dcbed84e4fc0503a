/// Addresses without end, such as those of forged samples: the beacons that were there first go on.

#include "clocks/clocks.hpp"
#include "support/pose_tap.hpp"
#include "support/ros2.hpp"
#include "support/udp_beacon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <set>
#include <sstream>
#include <stop_token>
#include <thread>
#include <unistd.h>

namespace many_addresses_test {

using namespace sonopose;
using namespace sonopose::test;

constexpr BeaconAddress healthy = 7;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double tolerated_mb = 2000;  // their allocators keep what is freed
constexpr double max_wait_s = 10;
#else
constexpr double tolerated_mb = 60;
constexpr double max_wait_s = 2;
#endif

/// A participant that writes a sample and a bridge's status of every other address, and then lives on.
class Forger {
public:
  explicit Forger(const Bus& bus)
      : participant_(dds::make_participant({.domain_id = bus.domain_id()})),
        imu_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::imu)),
        status_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::beacon_status)) {}

  void write_all(double duration_s, const std::stop_token& end = {}) {
    const auto begin = std::chrono::steady_clock::now();
    for (unsigned address = 0; address < all_beacons && !end.stop_requested(); ++address) {
      if (address == healthy) continue;
      ImuSample sample;
      sample.address = static_cast<BeaconAddress>(address);
      sample.sequence = 1;
      sample.sensor_time_ns = sample.bridge_time_ns = clocks::host_now();
      imu_.write(dds::topics::to_idl(sample));
      BeaconStatus status;
      status.address = sample.address;
      status.time_ns = sample.bridge_time_ns;
      status_.write(dds::topics::to_idl(status));
      std::this_thread::sleep_until(begin +
                                    std::chrono::duration<double>(duration_s * address / all_beacons));
    }
  }

private:
  dds::DomainParticipant participant_;
  dds::DataWriter<sonopose_ImuSample> imu_;
  dds::DataWriter<sonopose_BeaconStatus> status_;
};

/// Load and memory of a process.
struct Usage {
  double share = 0;  ///< of a core
  double memory_mb = 0;
};

double processor_time_s(int pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string text;
  std::getline(file, text);
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  std::string field;
  for (int i = 0; i < 11; ++i) fields >> field;
  double user = 0;
  double system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

double resident_mb(int pid) {
  std::ifstream file(fmt::format("/proc/{}/statm", pid));
  double total = 0;
  double resident = 0;
  file >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6;
}

/// The usage while `receive(seconds)` runs.
template <class Receive>
Usage usage(const Process& process, double seconds, const Receive& receive) {
  const SteadyTime begin = clocks::steady_now();
  const double used_s = processor_time_s(process.pid());
  receive(seconds);
  return {(processor_time_s(process.pid()) - used_s) / seconds_between(begin, clocks::steady_now()),
          resident_mb(process.pid())};
}

void check_as_before(const Usage& before, const Usage& during, const Usage& after, double most_more_mb) {
  std::cout << fmt::format("load {:.1f}, {:.1f}, {:.1f} %; memory {:.0f}, {:.0f}, {:.0f} MB; ",
                           100 * before.share, 100 * during.share, 100 * after.share, before.memory_mb,
                           during.memory_mb, after.memory_mb);
  CHECK(after.share < before.share + 0.1);
  CHECK(after.memory_mb < before.memory_mb + most_more_mb);
}

template <class Sample>
std::set<BeaconAddress> addresses_of(const std::vector<Sample>& samples, std::size_t first) {
  std::set<BeaconAddress> addresses;
  for (std::size_t i = first; i < samples.size(); ++i) addresses.insert(samples[i].address);
  return addresses;
}

/// The messages of the healthy beacon, as a ROS 2 process receives them.
class HealthyImu {
public:
  explicit HealthyImu(const Bus& bus) : reader_(bus, fmt::format("/hedge_{}/imu/data_raw", healthy)) {}

  /// Receives for this time; returns the longest wait for a message.
  double receive(double seconds) {
    const SteadyTime end = clocks::steady_now() + to_ns(seconds);
    return receive_until([end] { return clocks::steady_now() >= end; });
  }

  template <class Done>
  double receive_until(const Done& done) {
    SteadyTime latest = clocks::steady_now();
    double longest_s = 0;
    while (!done()) {
      REQUIRE(reader_.wait_for([](const ros2::Imu&) { return true; }));
      longest_s = std::max(longest_s, seconds_between(latest, clocks::steady_now()));
      latest = clocks::steady_now();
    }
    return longest_s;
  }

private:
  RosReader<ros2::Imu> reader_;
};

/// A fusion that serves the healthy beacon at 100 Hz.
struct ServedBeacon {
  Bus bus;
  std::unique_ptr<Process> fusion = bus.fusion();
  std::unique_ptr<Process> bridge = bus.bridge({"--address", std::to_string(healthy)});
  PoseTap poses{bus};

  /// Receives for this time.
  void receive(double seconds) const {
    const auto count = static_cast<std::size_t>(100 * seconds);
    REQUIRE(poses.wait_for_count(poses.count(), count).size() >= count);
  }
};

SCENARIO("forged addresses disturb nobody") {
  GIVEN("a fusion that serves a beacon at 100 Hz") {
    const ServedBeacon served;
    const auto receive = [&served](double seconds) { served.receive(seconds); };
    const Usage before = usage(*served.fusion, 3, receive);
    WHEN("one sample of each of the other 65,534 addresses comes within ten seconds") {
      Forger forger(served.bus);
      const std::size_t first = served.poses.count();
      const Usage flooded = usage(*served.fusion, 10, [&](double seconds) { forger.write_all(seconds); });
      const auto during = waits_between(served.poses.since(first));
      receive(10);
      THEN("ten seconds later everything is as before, though the writer lives on") {
        check_as_before(before, flooded, usage(*served.fusion, 3, receive), tolerated_mb);
        std::cout << fmt::format("longest wait for a pose {:.0f} ms\n", during.longest_ms);
        CHECK(during.longest_ms < 500 * max_wait_s);  // the engines of 256 more beacons are made at once
        CHECK(served.fusion->wait_for_line(Stream::error, "--max-beacons"));
        const PoseTap late(served.bus);
        CHECK(late.wait_for_count(0, 100).size() >= 100);
        for (const TappedPose& tapped : late.since(0)) CHECK(tapped.pose.address == healthy);
      }
    }
  }
}

SCENARIO("forged addresses disturb no relay") {
  GIVEN("a relay of a beacon at 100 Hz") {
    const Bus bus;
    const auto relay = bus.ros2();
    const auto bridge = bus.bridge({"--address", std::to_string(healthy)});
    HealthyImu imu(bus);
    imu.receive(1);
    Forger forger(bus);
    WHEN("the other 65,534 addresses come within four seconds") {
      const auto receive = [&imu](double seconds) { imu.receive(seconds); };
      const Usage before = usage(*relay, 2, receive);
      std::jthread flood([&] { forger.write_all(4.0); });
      double longest_s = 0;
      const Usage flooded = usage(*relay, 4, [&](double seconds) { longest_s = imu.receive(seconds); });
      flood.join();
      imu.receive(8);
      THEN("ten seconds later everything is as before, though the writer lives on") {
        check_as_before(before, flooded, usage(*relay, 2, receive), tolerated_mb);
        std::cout << fmt::format("longest wait for a message {:.0f} ms\n", 1000 * longest_s);
        CHECK(longest_s < max_wait_s);
        CHECK(relay->wait_for_line(Stream::error, "--max-beacons"));
        CHECK(relay->wait_for_line(Stream::error, "gone; its topics are closed"));
      }
    }
    WHEN("it is stopped in the middle of them") {
      std::jthread flood([&](const std::stop_token& end) { forger.write_all(4.0, end); });
      imu.receive(0.5);
      const auto ending = relay->end_by(SIGINT);
      THEN("it ends at once") {
        std::cout << fmt::format("ended after {} ms\n", ending.took.count());
        CHECK(ending.code == 0);
        CHECK(ending.took < std::chrono::duration<double>(max_wait_s));
      }
    }
  }
}

/// Sends the datagrams of a beacon in time while it lives.
class LiveBeacon {
public:
  LiveBeacon(const UdpSender& sender, const std::vector<TimedFrame>& datagrams)
      : thread_([&sender, &datagrams](const std::stop_token& end) {
          const auto begin = std::chrono::steady_clock::now();
          for (const TimedFrame& frame : datagrams) {
            if (end.stop_requested()) return;
            std::this_thread::sleep_until(begin + std::chrono::nanoseconds(frame.sent_after_ns));
            sender.send(frame.bytes);
          }
        }) {}

private:
  std::jthread thread_;
};

SCENARIO("forged datagrams of all addresses disturb no bridge") {
  GIVEN("a bridge that receives a beacon at 100 Hz") {
    const Bus bus;
    const auto datagrams = resting_beacon(bus, healthy, 25);
    const UdpSender sender;
    Consumer<sonopose_ImuSample> imu(bus, dds::topics::imu);
    const auto bridge = bus.bridge({"--source", "udp", "--listen", sender.endpoint()});
    REQUIRE(bridge->wait_for_line(Stream::error, "publishing from udp"));
    const LiveBeacon beacon(sender, datagrams);
    const auto of_healthy = [&imu](double seconds) {
      const auto count = static_cast<std::size_t>(100 * seconds);
      std::size_t seen = 0;
      REQUIRE(
          imu.wait_for([&](const ImuSample& sample) { return sample.address == healthy && ++seen == count; },
                       imu.samples.size()));
    };
    of_healthy(1);
    const Usage before = usage(*bridge, 2, of_healthy);
    WHEN("another sender sends forty datagrams of each of the other 255 addresses in two seconds") {
      const UdpSender attacker(sender.to());
      std::vector<TimedFrame> imu_datagrams;
      std::copy_if(datagrams.begin(), datagrams.end(), std::back_inserter(imu_datagrams),
                   [](const TimedFrame& frame) { return frame.bytes[2] == 3; });
      const std::size_t first = imu.samples.size();
      const Usage flooded = usage(*bridge, 2, [&](double seconds) {
        constexpr int rounds = 40;
        const auto begin = std::chrono::steady_clock::now();
        for (int round = 0; round < rounds; ++round) {
          for (unsigned address = 0; address < 256; ++address) {
            if (address == healthy) continue;
            Bytes forged = imu_datagrams[static_cast<std::size_t>(round)].bytes;
            constexpr std::size_t address_at = 5 + 18;  // after the header; see marvelmind::RawImu
            forged[0] = forged[address_at] = static_cast<std::uint8_t>(address);
            attacker.send(forged);
          }
          std::this_thread::sleep_until(begin + std::chrono::duration<double>(seconds * round / rounds));
        }
      });
      of_healthy(8);
      THEN("ten seconds later everything is as before") {
        const std::set<BeaconAddress> forged = addresses_of(imu.samples, first);
        REQUIRE(forged.size() == 256);
        check_as_before(before, flooded, usage(*bridge, 2, of_healthy), tolerated_mb / 3);
        Consumer<sonopose_BeaconStatus> statuses(bus, dds::topics::beacon_status);
        REQUIRE(statuses.wait_for_count(3));
        CHECK(addresses_of(statuses.samples, 0) == std::set{healthy});
      }
    }
  }
}

SCENARIO("forged statuses disturb no bridge") {
  GIVEN("a bridge of a beacon at 100 Hz") {
    const Bus bus;
    Consumer<sonopose_TruthSample> truth(bus, dds::topics::truth);
    const auto bridge = bus.bridge({"--address", std::to_string(healthy)});
    const auto receive = [&truth](double seconds) {
      REQUIRE(truth.wait_for_more(static_cast<std::size_t>(100 * seconds)));
    };
    receive(1);
    const Usage before = usage(*bridge, 2, receive);
    WHEN("another process writes the status of the other 65,534 beacons within four seconds") {
      Forger forger(bus);
      const Usage flooded = usage(*bridge, 4, [&](double seconds) { forger.write_all(seconds); });
      receive(6);
      THEN("its load and memory are as before, though the writer lives on") {
        check_as_before(before, flooded, usage(*bridge, 2, receive), tolerated_mb / 3);
      }
    }
  }
}

/// Writes statuses of fusions and lines that do not exist, each once.
void forge_ids(const Bus& bus, double duration_s) {
  const auto participant = dds::make_participant({.domain_id = bus.domain_id()});
  const dds::qos::Provider qos;
  auto statuses = dds::topics::make_writer(participant, qos, dds::topics::fusion_status);
  auto estimates = dds::topics::make_writer(participant, qos, dds::topics::estimate);
  auto lines = dds::topics::make_writer(participant, qos, dds::topics::line_status);
  const auto begin = std::chrono::steady_clock::now();
  for (std::uint64_t id = 1; id <= all_beacons; ++id) {
    FusionStatus status;
    status.address = healthy;
    status.fusion_id = id;
    statuses.write(dds::topics::to_idl(status));
    Estimate estimate;
    estimate.address = healthy;
    estimate.fusion_id = id;
    estimates.write(dds::topics::to_idl(estimate));
    LineStatus line;
    line.name = "forged";
    line.bridge_id = id;
    lines.write(dds::topics::to_idl(line));
    std::this_thread::sleep_until(
        begin + std::chrono::duration<double>(duration_s * static_cast<double>(id) / all_beacons));
  }
  std::this_thread::sleep_for(std::chrono::seconds(1));  // the writers live on
}

SCENARIO("forged fusions and lines disturb no observer") {
  GIVEN("a monitor or relay of a beacon at 100 Hz") {
    const std::string name = GENERATE("monitor", "relay");
    const ServedBeacon served;
    const auto observer = name == "relay" ? served.bus.ros2() : served.bus.monitor({"--json"});
    const auto receive = [&served](double seconds) { served.receive(seconds); };
    receive(1);
    const Usage before = usage(*observer, 3, receive);
    WHEN("65,536 ids of fusions and lines come within ten seconds") {
      const Usage flooded = usage(*observer, 10, [&](double seconds) { forge_ids(served.bus, seconds); });
      receive(8);
      THEN("ten seconds later everything is as before") {
        std::cout << name << ": ";
        check_as_before(before, flooded, usage(*observer, 3, receive), tolerated_mb / 3);
        CHECK(flooded.memory_mb < before.memory_mb + tolerated_mb / 2);
        CHECK(observer->wait_for_line(Stream::error, "8 fusions of a beacon at a time"));
        std::cout << '\n';
      }
    }
  }
}

}  // namespace many_addresses_test
