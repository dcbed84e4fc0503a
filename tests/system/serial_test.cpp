/// The serial path: bytes of a simulated beacon through a pseudo-terminal, with a disconnection.

#include "marvelmind/encoder.hpp"
#include "support/beacon_bytes.hpp"
#include "support/bus.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include "system/doctor_run.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <optional>

namespace sonopose::serial_test {

using namespace sonopose::test;
namespace topics = dds::topics;
using namespace std::string_literals;

/// Position in the simulator's scenario "rest".
const Vector3d resting_place_world_m{1.0, 2.0, 0.5};

/// Bytes of a beacon at rest for four seconds.
std::vector<TimedFrame> resting_beacon(const Bus& bus, const std::filesystem::path& folder) {
  const std::string file = (folder / "bytes.bin").string();
  REQUIRE(bus.bridge({"--scenario", "rest", "--rate", "0", "--duration", "4", "--capture", file})
              ->wait_for_exit() == 0);
  return timed_frames(read_bytes(file));
}

bool is_right(const FusedPose& pose) {
  return (pose.status & status_initialising) == 0U &&
         (pose.position_world_m - resting_place_world_m).norm() < 0.10;
}

std::span<const TimedFrame> between(const std::vector<TimedFrame>& frames, double from_s, double until_s) {
  const auto at = [&frames](double time_s) {
    return std::find_if(frames.begin(), frames.end(),
                        [time_s](const TimedFrame& frame) { return frame.sent_after_ns >= to_ns(time_s); });
  };
  return {at(from_s), at(until_s)};
}

/// Sends like a beacon whose clock continues, the first frame immediately.
void send(std::span<const TimedFrame> frames, const PseudoTerminal& line) {
  std::vector<TimedFrame> from_now(frames.begin(), frames.end());
  const TimeNs first_ns = from_now.front().sent_after_ns;
  for (TimedFrame& frame : from_now) frame.sent_after_ns -= first_ns;
  send_in_time(from_now, [&line](std::span<const std::uint8_t> bytes) { line.send(bytes); });
}

Bytes bytes_of(std::span<const TimedFrame> frames) {
  Bytes bytes;
  for (const TimedFrame& frame : frames) bytes.insert(bytes.end(), frame.bytes.begin(), frame.bytes.end());
  return bytes;
}

SCENARIO("a beacon on a serial line is unplugged and plugged in again, and poses resume") {
  GIVEN("a fusion, a bridge on a device that does not exist yet, and a beacon") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto frames = resting_beacon(bus, folder.path());
    const auto device = folder / "ttyACM0";
    const auto capture = folder / "capture.bin";
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    Consumer<sonopose_BeaconStatus> status(bus, topics::beacon_status);
    const auto fusion = bus.fusion();
    REQUIRE(poses.wait_for_writers());
    const auto bridge =
        bus.bridge({"--source", "serial", "--device", device.string(), "--capture", capture.string()});
    REQUIRE(bridge->wait_for_line(Stream::error, "waiting for " + device.string()));
    WHEN("the beacon is plugged in and sends") {
      std::optional<PseudoTerminal> line(std::in_place);
      std::filesystem::create_symlink(line->device(), device);
      REQUIRE(bridge->wait_for_line(Stream::error, "reading " + device.string()));
      const auto first = between(frames, 0.0, 2.0);
      send(first, *line);
      THEN("poses arrive, at the position of the beacon") {
        REQUIRE(poses.wait_for(is_right));
        REQUIRE(status.wait_for([&first](const BeaconStatus& now) { return now.frames == first.size(); }));
        AND_WHEN("it is unplugged, reappears under another device name, and continues") {
          const auto logs_twice = [&bridge](const std::string& text) {
            return wait_until([&] {
              const auto logged = bridge->lines(Stream::error);
              return std::count_if(logged.begin(), logged.end(), [&text](const std::string& each) {
                       return each.find(text) != std::string::npos;
                     }) == 2;
            });
          };
          line.reset();
          std::filesystem::remove(device);
          REQUIRE(logs_twice("waiting for " + device.string()));
          poses.take();
          const std::size_t since = poses.samples.size();
          line.emplace();
          std::filesystem::create_symlink(line->device(), device);
          REQUIRE(logs_twice("reading " + device.string()));
          send(between(frames, 2.0, 3.0), *line);
          THEN("poses arrive again, and the capture contains every byte of both connections") {
            CHECK(poses.wait_for(is_right, since));
            const auto sent = between(frames, 0.0, 3.0);
            REQUIRE(status.wait_for([&sent](const BeaconStatus& now) { return now.frames == sent.size(); }));
            CHECK(status.samples.back().crc_errors == 0);
            CHECK(status.samples.back().bytes_lost == 0);
            CHECK(bridge->end_by(SIGTERM).code == 0);
            const bool same = read_bytes(capture) == bytes_of(sent);
            CHECK(same);
          }
        }
      }
    }
  }
}

SCENARIO("a serial line is visible on the bus before any beacon address is known") {
  GIVEN("a bridge on a device that is absent") {
    const Bus bus;
    const TemporaryFolder folder;
    const auto device = folder / "ttyACM0";
    Consumer<sonopose_LineStatus> lines(bus, topics::line_status);
    const auto bridge = bus.bridge({"--source", "serial", "--device", device.string()});
    THEN("its line waits, and says why") {
      REQUIRE(lines.wait_for([&device](const LineStatus& line) {
        return line.name == device.string() && line.state == LineState::waiting && !line.text.empty() &&
               line.bytes == 0;
      }));
    }
    WHEN("the device appears and sends only noise") {
      const PseudoTerminal line;
      std::filesystem::create_symlink(line.device(), device);
      REQUIRE(bridge->wait_for_line(Stream::error, "reading " + device.string()));
      line.send(Bytes(1000, 0x55));
      THEN("the line is open and counts bytes, but no frame") {
        REQUIRE(lines.wait_for([](const LineStatus& now) {
          return now.state == LineState::open && now.bytes == 1000 && now.text.empty();
        }));
        CHECK(lines.samples.back().frames == 0);
        CHECK(lines.samples.back().bytes_lost > 0);
        CHECK(lines.samples.back().bridge_id != 0);
        AND_THEN(
            "it is reported as a line without frames, on the bus, by the bridge, the monitor and the "
            "doctor") {
          const auto monitor = bus.monitor({"--json"});
          REQUIRE(lines.wait_for([](const LineStatus& now) { return now.state == LineState::no_frames; }));
          CHECK_THAT(lines.samples.back().text, Catch::Contains("1000 bytes without a valid frame"));
          CHECK(bridge->wait_for_line(Stream::error, device.string() + ": 1000 bytes without a valid frame"));
          CHECK(
              monitor->wait_for_line(Stream::output, device.string() + ": 1000 bytes without a valid frame"));
          const std::string finding = "line " + device.string() + ": 1000 bytes without";
          const Result doctor = look_for(finding, bus.domain_id(), {"--duration", "0.5"});
          CHECK(doctor.code == 1);
          CHECK_THAT(doctor.output, Catch::Contains(finding));
        }
      }
    }
  }
}

SCENARIO("what arrives on a serial line instead of a beacon is named with the setting to change") {
  GIVEN("a bridge on a serial line") {
    const Bus bus;
    const PseudoTerminal line;
    const auto bridge = bus.bridge({"--source", "serial", "--device", line.device()});
    REQUIRE(bridge->wait_for_line(Stream::error, "reading " + line.device()));
    const auto [message, name] = GENERATE(
        std::pair("$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"s,
                  "NMEA sentences ($GPGGA)"),
        std::pair("\xB5\x62\x05\x01\x02\x00\x06\x01\x0F\x38"s, "messages of a u-blox receiver (UBX)"));
    WHEN("another protocol arrives") {
      for (int i = 0; i < 100; ++i) line.send(Bytes(message.begin(), message.end()));
      THEN("the bridge says so, and not to check the baud rate") {
        REQUIRE(bridge->wait_for_line(Stream::error, std::string("they are ") + name));
        CHECK_THAT(bridge->text(Stream::error),
                   Catch::Contains("warning: " + line.device() + ": ") &&
                       Catch::Contains(std::string(" bytes without a valid frame: they are ") + name +
                                       "; set the protocol of the beacon's UART and USB output to Marvelmind "
                                       "(Dashboard, Interfaces), or choose another --device") &&
                       !Catch::Contains("--baud"));
      }
    }
  }
}

SCENARIO("a second bridge on the same device waits until the first one has ended") {
  GIVEN("two bridges on one line") {
    const Bus bus;
    const PseudoTerminal line;
    const auto first = bus.bridge({"--source", "serial", "--device", line.device()});
    REQUIRE(first->wait_for_line(Stream::error, "reading " + line.device()));
    const auto second = bus.bridge({"--source", "serial", "--device", line.device()});
    THEN("the second one names the first one, and reads after its end") {
      REQUIRE(second->wait_for_line(
          Stream::error, "in use by sonopose-bridge (process " + std::to_string(first->pid()) + ")"));
      CHECK_THAT(second->text(Stream::error), !Catch::Contains("publishing from"));
      REQUIRE(first->end_by(SIGKILL).code == -SIGKILL);
      CHECK(second->wait_for_line(Stream::error, "reading " + line.device()));
    }
  }
}

SCENARIO("the map that a beacon sends reaches consumers, also one that joins later") {
  GIVEN("a bridge on a serial line") {
    const Bus bus;
    const PseudoTerminal line;
    Consumer<sonopose_StationaryBeacon> map(bus, topics::stationary_beacon);
    const auto bridge = bus.bridge({"--source", "serial", "--device", line.device()});
    REQUIRE(bridge->wait_for_line(Stream::error, "reading"));
    REQUIRE(map.wait_for_writers());
    const auto is_at = [](double z_m) {
      return [z_m](const StationaryBeacon& beacon) {
        return beacon.address == 2 && beacon.position_world_m &&
               beacon.position_world_m->isApprox(Vector3d(1, 2, z_m));
      };
    };
    WHEN("a beacon sends a map with a beacon at (1, 2, 3) m, repeats it, and sends it with another place") {
      marvelmind::StationaryBeacons sent;
      sent.count = 1;
      sent.items[0] = {.address = 2, .xyz_mm = {1000, 2000, 3000}};
      line.send(marvelmind::encode(sent).bytes());
      REQUIRE(map.wait_for(is_at(3.0)));
      line.send(marvelmind::encode(sent).bytes());
      sent.items[0].xyz_mm[2] = 2500;
      line.send(marvelmind::encode(sent).bytes());
      THEN("each place is published once, and a late consumer receives the latest") {
        REQUIRE(map.wait_for(is_at(2.5)));
        CHECK(map.samples.size() == 2);
        Consumer<sonopose_StationaryBeacon> late(bus, topics::stationary_beacon);
        REQUIRE(late.wait_for(is_at(2.5)));
        CHECK(late.samples.size() == 1);
      }
    }
  }
}

}  // namespace sonopose::serial_test
