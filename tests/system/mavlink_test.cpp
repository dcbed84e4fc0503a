/// sonopose-mavlink and an autopilot at the other end of its line.

#include "autopilot/external_odometry.hpp"
#include "clocks/clocks.hpp"
#include "mavlink/messages.hpp"
#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"
#include "support/bus.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include "transport/udp_peer.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <stop_token>
#include <thread>

namespace mavlink_system_test {

using namespace sonopose;
using namespace sonopose::test;

template <class T>
T at(const mavlink::Frame& frame, std::size_t offset) {
  T value{};
  std::memcpy(&value, frame.payload.data() + offset, sizeof value);
  return value;
}

constexpr std::uint32_t odometry_id = 331;
constexpr std::uint32_t timesync_id = 111;

/// An autopilot on a UDP port. It only hears until it is told to be alive: then it sends heartbeats and
/// requests the time, five times a second.
class Autopilot {
public:
  /// `disturbed_port`: port to which it sends before each heartbeat the beginning of a frame too, without
  /// having heard from it.
  explicit Autopilot(std::uint8_t kind, std::uint16_t disturbed_port = 9)
      : disturbed_port_(disturbed_port), kind_(kind) {}

  [[nodiscard]] std::string endpoint() const { return "127.0.0.1:" + std::to_string(port); }
  void live(bool alive) { alive_ = alive; }

  /// Number of frames of a message so far.
  std::size_t count(std::uint32_t message_id) {
    const std::lock_guard lock(mutex_);
    return frames_[message_id].size();
  }
  std::vector<mavlink::Frame> frames(std::uint32_t message_id) {
    const std::lock_guard lock(mutex_);
    return frames_[message_id];
  }
  bool wait_for(std::uint32_t message_id, std::size_t more) {
    const std::size_t before = count(message_id);
    const auto give_up = std::chrono::steady_clock::now() + timeout;
    while (count(message_id) < before + more) {
      if (std::chrono::steady_clock::now() > give_up) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }

  static constexpr std::int64_t own_clock_ns = 12'345'678'901;

  /// A port that was free a moment ago.
  static std::uint16_t free_port() {
    const auto probe = transport::open_udp_listener({"127.0.0.1", 0});
    return transport::parse_endpoint(probe->name().substr(4)).port;  // "udp 127.0.0.1:…"
  }

private:
  void run(const std::stop_token& end) {
    const auto line = transport::open_udp_peer({"127.0.0.1", disturbed_port_}, port);
    mavlink::Decoder decoder;
    std::array<std::uint8_t, 2048> buffer{};
    std::uint8_t sequence = 0;
    auto due = std::chrono::steady_clock::now();
    while (!end.stop_requested()) {
      const auto result = line->read(buffer, std::chrono::milliseconds(50));
      if (result.status == transport::ReadStatus::data) {
        line->answer_last_sender();
        decoder.feed({buffer.data(), result.size}, [this](const mavlink::Frame& frame) {
          const std::lock_guard lock(mutex_);
          frames_[frame.message_id].push_back(frame);
        });
      }
      if (!alive_ || std::chrono::steady_clock::now() < due) continue;
      due = std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
      if (disturbed_port_ != 9) {
        for (int i = 0; i < 50; ++i) line->send({0xFD, 255, 0});
      }
      auto heartbeat = mavlink::heartbeat({5, 1});
      heartbeat.payload[5] = kind_;
      line->send(encode(heartbeat, sequence++));
      mavlink::Frame request{.message_id = timesync_id, .sender = {5, 1}, .payload = {}, .size = 18};
      std::memcpy(request.payload.data() + 8, &own_clock_ns, sizeof own_clock_ns);
      line->send(encode(request, sequence++));
    }
  }

public:
  const std::uint16_t port = free_port();

private:
  std::uint16_t disturbed_port_;
  std::uint8_t kind_;
  std::atomic<bool> alive_ = false;
  std::mutex mutex_;
  std::map<std::uint32_t, std::vector<mavlink::Frame>> frames_;
  std::jthread thread_{[this](const std::stop_token& end) { run(end); }};
};

std::unique_ptr<Process> sender(const Bus& bus, Arguments arguments) {
  arguments.insert(arguments.end(), {"--domain", std::to_string(bus.domain_id())});
  auto process = std::make_unique<Process>(SONOPOSE_TEST_MAVLINK, arguments);
  REQUIRE(process->wait_for_line(Stream::error, "serving"));
  return process;
}

SCENARIO("an autopilot gets no poses that are stamped by another clock than that of the host") {
  const Bus bus;
  const TemporaryFolder folder;
  {
    sim::Simulator simulator(sim::find_scenario("drone"), {.duration_s = 60.0});
    recording::SensorLogWriter log(folder / "drive");
    while (const auto step = simulator.next()) log.write(step->event);
    log.flush();
  }
  const auto fusion = bus.fusion();
  GIVEN("a PX4, and a recording with its own stamps") {
    Autopilot px4(mavlink::autopilot_px4);
    px4.live(true);
    const auto mavlink = sender(bus, {"--udp", px4.endpoint()});
    const auto bridge = bus.bridge({"--source", "log", "--input", (folder / "drive").string()});
    THEN("nothing is sent, and the log says so") {
      CHECK(mavlink->wait_for_line(Stream::error,
                                   "their stamps are more than 1 s from the time of this machine"));
      CHECK(px4.count(odometry_id) == 0);
    }
  }
}

SCENARIO("an autopilot gets the poses of a drone over MAVLink") {
  const Bus bus;
  const auto fusion = bus.fusion();
  const auto bridge = bus.bridge({"--source", "sim", "--scenario", "drone"});
  GIVEN("a PX4 that is silent") {
    Autopilot px4(mavlink::autopilot_px4);
    const auto mavlink = sender(bus, {"--udp", px4.endpoint(), "--north", "90"});
    THEN("it gets heartbeats, and no pose, for a reason") {
      CHECK(px4.wait_for(0, 2));
      CHECK(mavlink->wait_for_line(Stream::error, "no heartbeats from an autopilot"));
      CHECK(px4.count(odometry_id) == 0);
      AND_WHEN("it comes to life") {
        px4.live(true);
        REQUIRE(px4.wait_for(odometry_id, 50));
        const auto frame = px4.frames(odometry_id).back();
        THEN(
            "it gets poses of its vehicle, in its axes and with the host's time, and answers about the "
            "time") {
          CHECK(frame.sender == mavlink::Identity{5, mavlink::own_component});
          CHECK(int{frame.payload[228]} == 1);  // MAV_FRAME_LOCAL_NED
          CHECK(int{frame.payload[229]} == 12);
          CHECK(std::llabs(static_cast<TimeNs>(at<std::uint64_t>(frame, 0)) * 1000 - clocks::host_now()) <
                60'000'000'000);
          CHECK(std::isfinite(at<float>(frame, 8)));
          CHECK(at<float>(frame, 60) > 0);
          std::uint64_t last_us = 0;
          for (const auto& each : px4.frames(odometry_id)) {
            CHECK(at<std::uint64_t>(each, 0) > last_us);
            last_us = at<std::uint64_t>(each, 0);
          }
          REQUIRE(px4.wait_for(timesync_id, 1));
          const auto answer = px4.frames(timesync_id).back();
          CHECK(at<std::int64_t>(answer, 8) == Autopilot::own_clock_ns);
          CHECK(std::llabs(at<std::int64_t>(answer, 0) - clocks::host_now()) < 60'000'000'000);
          CHECK(int{answer.payload[16]} == 5);
          AND_WHEN("the engine is started again") {
            const int before = px4.frames(odometry_id).back().payload[230];
            REQUIRE(bus.settings({"reset", "--beacon", "7"}).code == 0);
            REQUIRE(px4.wait_for(odometry_id, 100));
            THEN("the reset counter has risen by one") {
              CHECK(int{px4.frames(odometry_id).back().payload[230]} == before + 1);
              AND_WHEN("it dies") {
                REQUIRE(mavlink->wait_for_line(Stream::error, "sending the poses of beacon 7"));
                const auto ends = [&] {
                  const auto lines = mavlink->lines(Stream::error);
                  return std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
                    return line.find("no heartbeats from an autopilot") != std::string::npos;
                  });
                };
                const auto before_death = ends();
                px4.live(false);
                THEN("the poses end, and the log says so") {
                  CHECK(wait_until([&] { return ends() > before_death; }));
                }
              }
            }
          }
        }
      }
    }
  }
  GIVEN("a PX4, and another program of its machine that sends as the same system, and broken frames") {
    Autopilot px4(mavlink::autopilot_px4);
    const std::uint16_t own_port = Autopilot::free_port();
    const auto mavlink = sender(bus, {"--udp", px4.endpoint(), "--local-port", std::to_string(own_port)});
    px4.live(true);
    REQUIRE(px4.wait_for(odometry_id, 10));
    Autopilot other(mavlink::autopilot_px4, own_port);
    other.live(true);
    THEN("the PX4 gets the poses, longer than one without heartbeats would") {
      CHECK(px4.wait_for(odometry_id, 200));
      CHECK(other.count(odometry_id) == 0);
      CHECK(other.count(timesync_id) == 0);
    }
  }
  GIVEN("an ArduPilot, and VISION_POSITION_ESTIMATE") {
    Autopilot ardupilot(mavlink::autopilot_ardupilot);
    const auto mavlink =
        sender(bus, {"--udp", ardupilot.endpoint(), "--north", "90", "--message", "vision_position"});
    ardupilot.live(true);
    THEN("it gets that message") {
      REQUIRE(ardupilot.wait_for(102, 20));
      CHECK(ardupilot.count(odometry_id) == 0);
    }
  }
  GIVEN("an ArduPilot, and ODOMETRY") {
    Autopilot ardupilot(mavlink::autopilot_ardupilot);
    const auto mavlink = sender(bus, {"--udp", ardupilot.endpoint(), "--north", "90"});
    ardupilot.live(true);
    THEN("the frame is the only one that it takes") {
      REQUIRE(ardupilot.wait_for(odometry_id, 1));
      CHECK(int{ardupilot.frames(odometry_id).back().payload[228]} == 20);  // MAV_FRAME_LOCAL_FRD
    }
  }
}

TEST_CASE("sonopose-mavlink refuses a line that it cannot use") {
  const auto refusal = [](const Arguments& arguments) {
    const Result result = run(SONOPOSE_TEST_MAVLINK, arguments);
    CHECK(result.code.value_or(0) > 0);
    return result.error;
  };
  CHECK(refusal({}).find("give one of --udp and --device") != std::string::npos);
  CHECK(refusal({"--udp", "127.0.0.1:0"}).find("port 0") != std::string::npos);
  CHECK(refusal({"--udp", "drone:1"}).find("not a numeric IP address") != std::string::npos);
  CHECK(refusal({"--device", "/etc/hostname"}).find("is not a serial device") != std::string::npos);
  CHECK(refusal({"--device", "/dev/ttyTHS1:fast"}).find("'fast' is not a baud rate") != std::string::npos);
  const std::string udp = "127.0.0.1:14550";
  CHECK(refusal({"--device", "/dev/ttyTHS1:0"}).find("baud rate of 0") != std::string::npos);
  CHECK(refusal({"--udp", udp, "--device", "/dev/ttyTHS1"}).find("--device") != std::string::npos);
  CHECK(refusal({"--udp", udp, "--addresses", "70000"}).find("--addresses: ") != std::string::npos);
  CHECK(refusal({"--udp", udp, "--rate", "0"}).find("--rate: ") != std::string::npos);
  CHECK(refusal({"--udp", udp, "--north", "nan"}).find("--north: ") != std::string::npos);
  CHECK(refusal({"--udp", udp, "--message", "pose"}).find("--message: ") != std::string::npos);
  CHECK(refusal({"--udp", udp, "--local-port", "70000"}).find("--local-port: ") != std::string::npos);
  CHECK(refusal({"--udp", udp, "--mount", "0", "0", "nan", "0", "0", "0"}).find("--mount: z is nan") !=
        std::string::npos);
}

TEST_CASE(
    "a wrong line in the file of sonopose-mavlink is named, and ends the retries of a service manager") {
  const TemporaryFolder folder;
  const std::string file = (folder / "mavlink.toml").string();
  for (const std::string device : {"/dev/null", "/dev/ttyTHS1:0"}) {
    write_text(file, "\ndevice = \"" + device + "\"\n");
    const Result result = run(SONOPOSE_TEST_MAVLINK, {"--config", file}, neutral);
    CAPTURE(result.error);
    CHECK(result.code == 78);
    CHECK(result.error.find(file + ":2: device: --device: ") != std::string::npos);
  }
}

}  // namespace mavlink_system_test
