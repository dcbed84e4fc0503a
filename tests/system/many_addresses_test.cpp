/// Unlimited addresses, as of forged samples: the first beacons continue.

#include "clocks/clocks.hpp"
#include "support/beacon_feed.hpp"
#include "support/pose_tap.hpp"
#include "support/ros2.hpp"
#include "support/udp_sender.hpp"
#include "support/wait_until.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <mutex>
#include <set>
#include <unistd.h>

namespace sonopose::many_addresses_test {

using namespace sonopose::test;

constexpr BeaconAddress healthy = 7;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double tolerated_mb = 2000;  // the sanitizers' allocators keep freed memory
#else
constexpr double tolerated_mb = 25;
#endif

/// Resource usage of a process.
struct Usage {
  double processor_s = 0;  ///< processor time per sample of the healthy beacon
  double memory_mb = 0;
  std::ptrdiff_t threads = 0;
  std::ptrdiff_t descriptors = 0;
};

double processor_time_s(int pid) {
  clockid_t clock = 0;
  timespec time{};
  REQUIRE(::clock_getcpuclockid(pid, &clock) == 0);
  REQUIRE(::clock_gettime(clock, &time) == 0);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::ptrdiff_t entries_of(int pid, const char* folder) {
  const std::filesystem::directory_iterator entries(fmt::format("/proc/{}/{}", pid, folder));
  return std::distance(begin(entries), end(entries));
}

Usage usage_of(int pid) {
  std::ifstream file(fmt::format("/proc/{}/statm", pid));
  double total = 0;
  double resident = 0;
  file >> total >> resident;
  return {.memory_mb = resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) * 1e-6,
          .threads = entries_of(pid, "task"),
          .descriptors = entries_of(pid, "fd")};
}

/// A process whose usage must be the same before and after a flood.
struct Observed {
  std::string name;
  Process& process;
  double more_mb;  ///< additional memory allowed afterwards
  Usage before{};
  Usage after{};
};

/// Measures the processes while `receive(count)` waits for samples of the healthy beacon.
template <class Receive>
void measure(std::vector<Observed>& all, Usage Observed::*moment, const Receive& receive) {
  constexpr std::size_t count = 25;
  for (Observed& each : all) (each.*moment).processor_s = -processor_time_s(each.process.pid());
  receive(count);
  for (Observed& each : all) {
    const double used_s = (each.*moment).processor_s + processor_time_s(each.process.pid());
    each.*moment = usage_of(each.process.pid());
    (each.*moment).processor_s = used_s / count;
  }
}

/// Measures before a flood, until no thread or descriptor of the start is added any more.
template <class Receive>
void measure_before(std::vector<Observed>& all, const Receive& receive) {
  const auto count = [&all] {
    std::ptrdiff_t sum = 0;
    for (const Observed& each : all) sum += each.before.threads + each.before.descriptors;
    return sum;
  };
  std::ptrdiff_t previous = 0;
  do {
    previous = count();
    measure(all, &Observed::before, receive);
  } while (count() != previous);
}

constexpr double tolerated_ratio = 5;  ///< ratio of the processor times

bool is_as_before(const Observed& each) {
  return each.after.processor_s < tolerated_ratio * each.before.processor_s &&
         each.after.memory_mb < each.before.memory_mb + each.more_mb &&
         each.after.threads == each.before.threads && each.after.descriptors == each.before.descriptors;
}

/// Measures until the processes are as before: the latest addresses are released after 5 s, and memory every
/// 10 s.
template <class Receive>
void check_as_before(std::vector<Observed>& all, const Receive& receive) {
  for (int i = 0; i < 30; ++i) {
    measure(all, &Observed::after, receive);
    if (std::all_of(all.begin(), all.end(), is_as_before)) break;
  }
  for (const auto& [name, process, more_mb, before, after] : all) {
    CAPTURE(name);
    std::cout << fmt::format(
        "{}: {:.0f} and {:.0f} us of a processor for each sample; {:.0f} and {:.0f} MB\n", name,
        1e6 * before.processor_s, 1e6 * after.processor_s, before.memory_mb, after.memory_mb);
    CHECK(after.processor_s < tolerated_ratio * before.processor_s);
    CHECK(after.memory_mb < before.memory_mb + more_mb);
    CHECK(after.threads == before.threads);
    CHECK(after.descriptors == before.descriptors);
  }
}

template <class Sample>
std::set<BeaconAddress> addresses_of(const std::vector<Sample>& samples, std::size_t first) {
  std::set<BeaconAddress> addresses;
  for (std::size_t i = first; i < samples.size(); ++i) addresses.insert(samples[i].address);
  return addresses;
}

constexpr unsigned flood_pieces = 16;

/// Writes a sample and a bridge's status of every fourth address, and then stays alive.
class Forger {
public:
  explicit Forger(const Bus& bus)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})),
        imu_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::imu)),
        status_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::beacon_status)) {}

  /// Writes the pieces and calls `go_on()` after each.
  template <class GoOn>
  void write(unsigned pieces, const GoOn& go_on) {
    constexpr unsigned spacing = 4;
    static_assert(healthy % spacing != 0);
    constexpr unsigned piece = (all_beacons + 1U) / flood_pieces;
    for (unsigned address = 0; address < pieces * piece; address += spacing) {
      ImuSample sample;
      sample.address = static_cast<BeaconAddress>(address);
      sample.sequence = 1;
      sample.sensor_time_ns = sample.bridge_time_ns = clocks::host_now();
      imu_.write(dds::topics::to_idl(sample));
      BeaconStatus status;
      status.address = sample.address;
      status.time_ns = sample.bridge_time_ns;
      status_.write(dds::topics::to_idl(status));
      if (address % piece == piece - spacing) go_on();
    }
  }

private:
  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<sonopose_ImuSample> imu_;
  dds::pub::DataWriter<sonopose_BeaconStatus> status_;
};

/// Writes one status each of nonexistent fusions and lines. Calls `go_on()` after each piece.
class IdForger {
public:
  explicit IdForger(const Bus& bus)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})),
        statuses_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::fusion_status)),
        estimates_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::estimate)),
        lines_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::line_status)) {}

  template <class GoOn>
  void write_all(const GoOn& go_on) {
    constexpr std::uint64_t count = 16'384;  // far more than an observer admits
    for (std::uint64_t id = 1; id <= count; ++id) {
      FusionStatus status;
      status.address = healthy;
      status.fusion_id = id;
      statuses_.write(dds::topics::to_idl(status));
      Estimate estimate;
      estimate.address = healthy;
      estimate.fusion_id = id;
      estimates_.write(dds::topics::to_idl(estimate));
      LineStatus line;
      line.name = "forged";
      line.bridge_id = id;
      lines_.write(dds::topics::to_idl(line));
      if (id % (count / flood_pieces) == 0) go_on();
    }
  }

private:
  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<sonopose_FusionStatus> statuses_;
  dds::pub::DataWriter<sonopose_Estimate> estimates_;
  dds::pub::DataWriter<sonopose_LineStatus> lines_;
};

/// A fusion and a relay that admit few beacons, and the healthy beacon at 25 Hz.
struct ServedBeacon {
  Bus bus;
  std::unique_ptr<Process> fusion = bus.fusion({"--max-beacons", "64"});
  std::unique_ptr<Process> relay = bus.ros2({"--max-beacons", "64"});
  PoseTap poses{bus};
  RosReader<ros2::Imu> imu{bus, fmt::format("/hedge_{}/imu/data_raw", healthy)};
  std::unique_ptr<Process> bridge = bus.bridge({"--address", std::to_string(healthy), "--imu-rate", "25"});

  /// Waits for `count` more poses and a message of the relay.
  void receive(std::size_t count) {
    REQUIRE(imu.wait_for([](const ros2::Imu&) { return true; }));
    REQUIRE(poses.wait_for_count(poses.count(), count).size() >= count);
  }
};

SCENARIO("forged addresses disturb nobody") {
  GIVEN("a fusion, a relay and a bridge of a beacon") {
    ServedBeacon served;
    const auto receive = [&served](std::size_t count) { served.receive(count); };
    std::vector<Observed> all{{"fusion", *served.fusion, tolerated_mb},
                              {"relay", *served.relay, tolerated_mb},
                              {"bridge", *served.bridge, tolerated_mb / 2}};
    receive(1);
    measure_before(all, receive);
    WHEN("a sample and a status of each of 16,384 other addresses come") {
      Forger forger(served.bus);
      forger.write(flood_pieces, [&receive] { receive(2); });
      THEN(
          "the beacon is served meanwhile, and afterwards everything is as before, though the writer lives "
          "on") {
        CHECK(served.fusion->wait_for_line(Stream::error, "--max-beacons"));
        CHECK(served.relay->wait_for_line(Stream::error, "--max-beacons"));
        CHECK(served.fusion->wait_for_line(Stream::error, "gone; its estimate is discarded"));
        CHECK(served.relay->wait_for_line(Stream::error, "gone; its topics are closed"));
        check_as_before(all, receive);
        const PoseTap late(served.bus);
        CHECK(late.wait_for_count(0, 25).size() >= 25);
        for (const TappedPose& tapped : late.since(0)) CHECK(tapped.pose.address == healthy);
      }
    }
  }
}

SCENARIO("a relay ends in the middle of forged addresses") {
  GIVEN("a relay of a beacon") {
    ServedBeacon served;
    served.receive(1);
    WHEN("it is stopped after some of them") {
      Forger forger(served.bus);
      forger.write(flood_pieces / 2, [] {});
      const auto ending = served.relay->end_by(SIGINT);
      THEN("it ends as usual") {
        std::cout << fmt::format("ended after {} ms\n", ending.took.count());
        CHECK(ending.code == 0);
      }
    }
  }
}

SCENARIO("forged fusions and lines disturb no observer") {
  GIVEN("a monitor and a relay of a beacon") {
    ServedBeacon served;
    const auto monitor = served.bus.monitor({"--json"});
    const auto receive = [&served](std::size_t count) { served.receive(count); };
    std::vector<Observed> all{{"monitor", *monitor, tolerated_mb}, {"relay", *served.relay, tolerated_mb}};
    REQUIRE(monitor->wait_for_lines(Stream::output, 2));
    measure_before(all, receive);
    WHEN("16,384 ids of fusions and lines come") {
      IdForger forger(served.bus);
      forger.write_all([&receive] { receive(2); });
      THEN("everything is as before, though the writer lives on") {
        for (const Observed& each : all) {
          CAPTURE(each.name);
          CHECK(each.process.wait_for_line(Stream::error, "8 fusions of a beacon at a time"));
        }
        check_as_before(all, receive);
      }
    }
  }
}

/// A beacon at 100 Hz on a line, whose latest IMU datagram is readable.
class LiveBeacon {
public:
  explicit LiveBeacon(const UdpSender& sender)
      : feed_(BeaconFeed::Format::datagrams, 100, [this, &sender](std::span<const std::uint8_t> bytes) {
          sender.send(bytes);
          constexpr std::uint8_t imu_code = 3;
          const std::lock_guard lock(mutex_);
          if (bytes[2] == imu_code) imu_.assign(bytes.begin(), bytes.end());
        }) {
    feed_.add(healthy);
  }

  /// The latest IMU datagram, as if from the beacon of `address`.
  std::vector<std::uint8_t> forged(std::uint8_t address) const {
    const std::lock_guard lock(mutex_);
    auto bytes = imu_;
    constexpr std::size_t address_at = 5 + 18;  // after the header; see marvelmind::RawImu
    bytes.at(0) = bytes.at(address_at) = address;
    return bytes;
  }

private:
  mutable std::mutex mutex_;
  std::vector<std::uint8_t> imu_;
  BeaconFeed feed_;
};

SCENARIO("forged datagrams of all addresses disturb no bridge") {
  GIVEN("a bridge that receives a beacon at 100 Hz") {
    const Bus bus;
    const UdpSender sender;
    Consumer<sonopose_ImuSample> imu(bus, dds::topics::imu);
    const auto bridge = bus.bridge({"--source", "udp", "--listen", sender.endpoint()});
    REQUIRE(bridge->wait_for_line(Stream::error, "publishing from udp"));
    const LiveBeacon beacon(sender);
    const auto receive = [&imu](std::size_t count) {
      imu.take();
      std::size_t seen = 0;
      REQUIRE(
          imu.wait_for([&](const ImuSample& sample) { return sample.address == healthy && ++seen == count; },
                       imu.samples.size()));
    };
    receive(50);  // the backlog of the start has been taken
    std::vector<Observed> all{{"bridge", *bridge, tolerated_mb}};
    measure_before(all, receive);
    WHEN("another sender sends forty datagrams of each of the other 255 addresses") {
      const UdpSender attacker(sender.to());
      const std::size_t first = imu.samples.size();
      for (int round = 0; round < 40; ++round) {
        for (unsigned address = 0; address < 256; ++address) {
          if (address != healthy) attacker.send(beacon.forged(static_cast<std::uint8_t>(address)));
        }
        receive(2);
      }
      THEN("the beacon goes on meanwhile, and afterwards everything is as before") {
        REQUIRE(addresses_of(imu.samples, first).size() == 256);
        std::set<BeaconAddress> served;
        CHECK(wait_until([&] {
          Consumer<sonopose_BeaconStatus> statuses(bus, dds::topics::beacon_status);
          REQUIRE(statuses.wait_for_count(3));
          served = addresses_of(statuses.samples, 0);
          return served == std::set{healthy};
        }));
        check_as_before(all, receive);
      }
    }
  }
}

}  // namespace sonopose::many_addresses_test
