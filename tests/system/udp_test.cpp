/// The UDP path: datagrams of a simulated beacon.

#include "clocks/clocks.hpp"
#include "support/udp_beacon.hpp"
#include "support/wait_until.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

namespace sonopose::udp_test {

using namespace sonopose::test;
namespace topics = dds::topics;

/// Bytes in a port's receive queue. Empty if the kernel's list misses the socket, which happens while others
/// close.
std::optional<std::size_t> waiting_bytes(const sockaddr_in& at) {
  const std::string address = fmt::format("0100007F:{:04X}", ntohs(at.sin_port));
  std::ifstream sockets("/proc/net/udp");
  for (std::string number, local, remote, state, queues, rest;
       sockets >> number >> local >> remote >> state >> queues && std::getline(sockets, rest);) {
    if (local == address) return std::stoul(queues.substr(queues.find(':') + 1), nullptr, 16);
  }
  return std::nullopt;
}

/// A bridge that listens to this beacon.
std::unique_ptr<Process> listening_bridge(const Bus& bus, const UdpSender& beacon,
                                          const Arguments& further = {}) {
  Arguments arguments{"--source", "udp", "--listen", beacon.endpoint()};
  arguments.insert(arguments.end(), further.begin(), further.end());
  auto bridge = bus.bridge(arguments);
  REQUIRE(bridge->wait_for_line(Stream::error, "publishing from udp"));
  return bridge;
}

bool is_imu(const TimedFrame& frame) {
  return frame.bytes[2] == 3;
}

/// Longest interval between the stamps of two samples.
double longest_gap_s(const std::vector<ImuSample>& samples) {
  TimeNs longest_ns = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    longest_ns = std::max(longest_ns, samples[i].sensor_time_ns - samples[i - 1].sensor_time_ns);
  }
  return seconds_between(0, longest_ns);
}

SCENARIO("a flood of forged datagrams does not interrupt a beacon") {
  GIVEN("a listening bridge, and a beacon that sends") {
    const Bus bus;
    const auto datagrams = resting_beacon(bus, 21, 1);
    const UdpSender beacon;
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    Consumer<sonopose_LineStatus> lines(bus, topics::line_status);
    const auto bridge = listening_bridge(bus, beacon);
    REQUIRE(imu.wait_for_writers());
    const auto samples = std::count_if(datagrams.begin(), datagrams.end(), is_imu);
    const auto first = *std::find_if(datagrams.begin(), datagrams.end(), is_imu);
    beacon.send(first.bytes);
    REQUIRE(lines.wait_for([](const LineStatus& line) { return line.frames == 1; }));
    // The forged header announces more bytes than follow; a forged stamp would reset the beacon's clock.
    Bytes header(first.bytes.begin(), first.bytes.begin() + 5);
    header[4] = 255;
    for (const Bytes& forged : {header, first.bytes}) {
      WHEN("another sender floods the port with datagrams of " + std::to_string(forged.size()) + " bytes") {
        const UdpSender attacker(beacon.to());
        const SteadyTime began = clocks::steady_now();
        int sent = 0;
        SteadyTime last = began;
        TimeNs longest_sent_ns = 0;
        send_in_time(datagrams, [&](std::span<const std::uint8_t> bytes) {
          for (int i = 0; i < 100; ++i, ++sent) attacker.send(forged);
          // If a busy machine delays the bridge, its full receive buffer would lose the beacon's datagram.
          REQUIRE(wait_until([&] { return waiting_bytes(beacon.to()) == 0; }));
          beacon.send(bytes);
          const SteadyTime now = clocks::steady_now();
          longest_sent_ns = std::max(longest_sent_ns, now - last);
          last = now;
        });
        const double rate_hz = sent / seconds_between(began, clocks::steady_now());
        THEN("the beacon's samples are published without a gap, and no others") {
          REQUIRE(imu.wait_for_count(static_cast<std::size_t>(samples) - 10));
          CHECK(imu.samples.size() <= static_cast<std::size_t>(samples) + 1);
          const double gap_s = longest_gap_s(imu.samples);
          const double sent_gap_s = seconds_between(0, longest_sent_ns);
          std::cout << fmt::format("{:.0f} datagrams a second: longest gap {:.1f} ms, of its own {:.1f} ms\n",
                                   rate_hz, 1e3 * gap_s, 1e3 * sent_gap_s);
          CHECK(gap_s < 0.1 + sent_gap_s);
        }
      }
    }
    WHEN("another sender claims its address") {
      const UdpSender attacker(beacon.to());
      attacker.send(first.bytes);
      THEN("its packet is counted as refused, and both senders are logged") {
        CHECK(lines.wait_for([](const LineStatus& line) { return line.packets_refused == 1; }));
        CHECK(bridge->wait_for_line(Stream::error, "packets of beacon 21 from 127.0.0.1:"));
      }
    }
  }
}

SCENARIO("--from accepts one sender only") {
  const Bus bus;
  const auto datagrams = resting_beacon(bus, 21, 1);
  const UdpSender beacon;
  GIVEN("a bridge that accepts another machine") {
    Consumer<sonopose_LineStatus> lines(bus, topics::line_status);
    const auto bridge = listening_bridge(bus, beacon, {"--from", "192.0.2.1"});
    WHEN("a beacon of this machine sends") {
      beacon.send(datagrams.front().bytes);
      THEN("its datagram is counted as refused") {
        REQUIRE(lines.wait_for([](const LineStatus& line) { return line.packets_refused == 1; }));
        CHECK(lines.samples.back().frames == 0);
      }
    }
  }
  GIVEN("a bridge that accepts this machine") {
    Consumer<sonopose_ImuSample> imu(bus, topics::imu);
    const auto bridge = listening_bridge(bus, beacon, {"--from", "127.0.0.1"});
    REQUIRE(imu.wait_for_writers());
    WHEN("a beacon of this machine sends") {
      send_in_time(datagrams, [&beacon](std::span<const std::uint8_t> bytes) { beacon.send(bytes); });
      THEN("its samples are published") {
        CHECK(imu.wait_for([](const ImuSample& sample) { return sample.address == 21; }));
      }
    }
    WHEN("a forger of this machine sends from another port after the beacon") {
      Consumer<sonopose_LineStatus> lines(bus, topics::line_status);
      const UdpSender forger(beacon.to());
      const auto packet = *std::find_if(datagrams.begin(), datagrams.end(), is_imu);
      beacon.send(packet.bytes);
      forger.send(packet.bytes);
      THEN("its packet is refused") {
        CHECK(lines.wait_for([](const LineStatus& line) { return line.packets_refused == 1; }));
      }
    }
  }
}

SCENARIO("the datagrams of a beacon give poses") {
  GIVEN("a fusion, a listening bridge, and a beacon at rest") {
    const Bus bus;
    const UdpSender beacon;
    const auto datagrams = resting_beacon(bus, 21, 2);
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    REQUIRE(poses.wait_for_writers());
    const auto bridge = listening_bridge(bus, beacon);
    WHEN("the beacon sends") {
      send_in_time(datagrams, [&beacon](std::span<const std::uint8_t> bytes) { beacon.send(bytes); });
      THEN("poses arrive with its address, at its position") {
        CHECK(poses.wait_for([](const FusedPose& pose) {
          return pose.address == 21 && (pose.status & status_initialising) == 0U &&
                 (pose.position_world_m - Vector3d(1.0, 2.0, 0.5)).norm() < 0.10;
        }));
      }
    }
  }
}

}  // namespace sonopose::udp_test
