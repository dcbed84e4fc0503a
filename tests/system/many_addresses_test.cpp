/// Addresses without end, such as those of forged samples: the beacons that were there first go on.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"
#include "support/pose_tap.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <sstream>
#include <thread>
#include <unistd.h>

namespace many_addresses_test {

using namespace sonopose;
using namespace sonopose::test;

constexpr BeaconAddress healthy = 7;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double most_more_mb = 2000;  // their allocators keep what is freed
#else
constexpr double most_more_mb = 60;
#endif

/// A participant that writes one IMU sample of every other address, and then lives on.
class Forger {
public:
  explicit Forger(const Bus& bus)
      : participant_(dds::make_participant({.domain_id = bus.domain_id()})),
        writer_(dds::topics::make_writer(participant_, dds::qos::Provider(), dds::topics::imu)) {}

  void write_all(double duration_s) {
    const auto begin = std::chrono::steady_clock::now();
    for (unsigned address = 0; address < all_beacons; ++address) {
      if (address == healthy) continue;
      ImuSample sample;
      sample.address = static_cast<BeaconAddress>(address);
      sample.sequence = 1;
      sample.sensor_time_ns = sample.bridge_time_ns = clocks::host_now();
      writer_.write(dds::topics::to_idl(sample));
      std::this_thread::sleep_until(begin +
                                    std::chrono::duration<double>(duration_s * address / all_beacons));
    }
  }

private:
  dds::DomainParticipant participant_;
  dds::DataWriter<sonopose_ImuSample> writer_;
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

/// The share of a core that a process uses while `tap` receives `count` poses.
double load(const PoseTap& tap, int pid, std::size_t count) {
  const SteadyTime begin = clocks::steady_now();
  const double used_s = processor_time_s(pid);
  REQUIRE(tap.wait_for_count(tap.count(), count).size() >= count);
  return (processor_time_s(pid) - used_s) / seconds_between(begin, clocks::steady_now());
}

SCENARIO("forged addresses disturb nobody", "[load]") {
  GIVEN("a fusion that serves a beacon at 100 Hz") {
    const Bus bus;
    const auto fusion = bus.fusion();
    const auto bridge = bus.bridge({"--address", std::to_string(healthy)});
    const PoseTap tap(bus);
    const double load_before = load(tap, fusion->pid(), 300);
    const double memory_before_mb = resident_mb(fusion->pid());
    WHEN("one sample of each of the other 65,534 addresses comes within ten seconds") {
      Forger forger(bus);
      const std::size_t before = tap.count();
      forger.write_all(10.0);
      const double memory_during_mb = resident_mb(fusion->pid());
      const auto during = waits_between(tap.since(before));
      REQUIRE(tap.wait_for_count(tap.count(), 1000).size() >= 1000);
      THEN("ten seconds later everything is as before, though the writer lives on") {
        const double load_after = load(tap, fusion->pid(), 300);
        const double memory_after_mb = resident_mb(fusion->pid());
        std::cout << fmt::format(
            "load {:.1f} % before, {:.1f} % after; memory {:.0f}, {:.0f}, {:.0f} MB; longest wait for a pose "
            "{:.0f} ms\n",
            100 * load_before, 100 * load_after, memory_before_mb, memory_during_mb, memory_after_mb,
            during.longest_ms);
        CHECK(load_after < load_before + 0.1);
        CHECK(memory_after_mb < memory_before_mb + most_more_mb);
        CHECK(during.longest_ms < 1000);  // the engines of 256 more beacons are made at once
        CHECK(fusion->wait_for_line(Stream::error, "--max-beacons"));
        const PoseTap late(bus);
        CHECK(late.wait_for_count(0, 100).size() >= 100);
        for (const TappedPose& tapped : late.since(0)) CHECK(tapped.pose.address == healthy);
      }
    }
  }
}

}  // namespace many_addresses_test
