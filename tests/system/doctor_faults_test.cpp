/// Each fault that the doctor must find, with the real processes.

#include "marvelmind/encoder.hpp"
#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"
#include "support/beacon_bytes.hpp"
#include "support/bus.hpp"
#include "support/matches.hpp"
#include "support/temporary_folder.hpp"
#include "system/doctor_run.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>

namespace sonopose::doctor_faults_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

/// Warnings and errors about `subject` in a JSON report, one per line.
std::string problems_of(const nlohmann::json& report, const std::string& subject) {
  std::string text;
  for (const auto& finding : report["findings"]) {
    const std::string severity = finding["severity"];
    if (finding["subject"] != subject || (severity != "warning" && severity != "error")) continue;
    text += finding["what"].get<std::string>() + "; " + finding["remedy"].get<std::string>() + '\n';
  }
  return text;
}

/// The report with wrapped lines joined.
std::string unwrapped(const std::string& report) {
  return replace_matches(report, "\n +", " ");
}

/// Returns true if an unwrapped report has "READER on HOST) cannot receive from WRITER".
bool cannot_receive(const std::string& report, const std::string& reader, const std::string& writer) {
  const auto findings =
      all_matches(report, R"((\S+ \(process \d+)[^)]*\) cannot receive from (\S+ \(process \d+))");
  return std::ranges::any_of(findings,
                             [&](const auto& each) { return each[1] == reader && each[2] == writer; });
}

/// Mount of the pair, and a change of the samples.
struct Fault {
  double mount_deg = 0;
  std::function<void(Event& event, double time_s)> change = [](Event&, double) {};
};

/// Records a drive that is already under way.
void record_drive(const std::filesystem::path& folder, BeaconAddress address, const Fault& fault) {
  constexpr double begin_s = 4;
  constexpr double end_s = 90;
  const sim::Run run{.seed = 3000U + address, .address = address, .duration_s = end_s};
  sim::Scenario scenario = sim::find_scenario("forklift");
  scenario.sensors.pair_mount_offset_rad = fault.mount_deg * geometry::radians_per_degree;
  recording::SensorLogWriter writer(folder);
  for (Event& event : sim::record(scenario, run).events) {
    const double time_s = seconds_between(run.start_time_ns, available_at_ns(event)) - begin_s;
    if (time_s < 0) continue;
    fault.change(event, time_s);
    writer.write(event);
  }
  writer.flush();
}

SCENARIO("the doctor finds a wrong installation and wrong fixes of driving beacons") {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  WARN("skipped: with a sanitizer the fits take minutes; test_doctor has them one by one");
#else
  GIVEN("two beacons with one fault each, and one without") {
    std::mt19937 random(4711);
    const double mount_deg = std::round(std::uniform_real_distribution<double>(20, 160)(random));
    std::optional<Vector3d> frozen_at;
    const auto freeze = [&frozen_at](Event& event, double time_s) {
      auto* fix = std::get_if<UltrasonicFix>(&event);
      if (fix == nullptr || time_s < 4) return;
      if (!frozen_at) frozen_at = fix->position_world_m;
      fix->position_world_m = *frozen_at;
    };
    const std::map<BeaconAddress, Fault> faults{{10, {.mount_deg = mount_deg}},
                                                {11, {.mount_deg = mount_deg + 45}},
                                                {17, {.mount_deg = mount_deg, .change = freeze}}};
    const TemporaryFolder folder;
    const Bus bus;
    Consumer<sonopose_FusionStatus> statuses(bus, topics::fusion_status, topics::Delivery::live);
    const auto fusion =
        bus.fusion({"--set", "heading.mount_offset_deg=" + std::to_string(static_cast<int>(mount_deg))});
    std::vector<std::unique_ptr<Process> > bridges;
    const auto log_of = [&folder](BeaconAddress address) { return folder.path() / std::to_string(address); };
    for (const auto& [address, fault] : faults) record_drive(log_of(address), address, fault);
    for (const auto& entry : faults) {
      bridges.push_back(
          bus.bridge({"--source", "log", "--input", log_of(entry.first).string(), "--restamp"}));
    }
    // The start is over: however long it takes here, the doctor observes the same part of each drive.
    constexpr std::uint64_t min_fixes = 100;
    std::set<BeaconAddress> started;
    REQUIRE(statuses.wait_until([&] {
      for (const FusionStatus& status : statuses.samples) {
        if (status.fixes_used + status.fixes_rejected >= min_fixes) started.insert(status.address);
      }
      return started.size() == faults.size();
    }));
    WHEN("the doctor observes them for 18 s") {
      const std::string unfinished = "were not checked";
      const auto look_for_18_s = [&bus] { return look(bus.domain_id(), {"--duration", "18", "--json"}); };
      Result result = look_for_18_s();
      // A busy machine may leave the fits too little time.
      if (result.output.find(unfinished) != std::string::npos) result = look_for_18_s();
      CAPTURE(result.output, result.error);
      REQUIRE_THAT(result.output, !Contains(unfinished));
      REQUIRE(result.code == 1);
      const auto report = nlohmann::json::parse(result.output);
      const auto problems = [&report](int address) {
        return problems_of(report, "beacon " + std::to_string(address));
      };
      THEN("it finds each fault where it is, and none elsewhere") {
        CHECK(first_match(problems(10), "mount|assumes|wrong sign|track|repeat|headings|low trust|unknown")
                  .empty());
        CHECK_THAT(problems(11), Contains("its mount offset is wrong by about") &&
                                     !Contains("no valid fix"));  // a consequence of the fault
        const double tried_deg = value_of(problems(11), "heading.mount_offset_deg");
        CHECK(std::abs(std::remainder(tried_deg - faults.at(11).mount_deg, 360.0)) < 10);
        CHECK_THAT(problems(17), Contains("its fixes repeat one position although the IMU measures motion"));
      }
    }
  }
#endif
}

/// Records the bytes of a beacon at rest with a battery at 3.31 V.
void record_weak_battery(const Bus& bus, const std::filesystem::path& file) {
  const std::string sound = file.string() + ".sound";
  REQUIRE(bus.bridge({"--scenario", "rest", "--rate", "0", "--duration", "30", "--capture", sound})
              ->wait_for_exit() == 0);
  const auto telemetry =
      marvelmind::encode(marvelmind::Telemetry{.battery_mv = 3310, .rssi_dbm = -60, .address = 7});
  std::string bytes;
  int count = 0;
  for (const TimedFrame& frame : timed_frames(read_bytes(sound))) {
    bytes.append(frame.bytes.begin(), frame.bytes.end());
    if (++count % 50 == 0) bytes.append(telemetry.bytes().begin(), telemetry.bytes().end());
  }
  write_text(file, bytes);
}

SCENARIO("the doctor finds a weak battery, and a bridge that waits for its device") {
  GIVEN("a bridge that plays the bytes of a beacon at 3.31 V, and one whose serial device is absent") {
    const Bus bus;
    const TemporaryFolder folder;
    record_weak_battery(bus, folder / "weak.bin");
    Consumer<sonopose_LineStatus> lines(bus, topics::line_status);
    Consumer<sonopose_BeaconStatus> statuses(bus, topics::beacon_status, dds::topics::Delivery::live);
    const auto fusion = bus.fusion();  // a recording waits for a reader
    const auto bridge = bus.bridge({"--source", "stream", "--input", (folder / "weak.bin").string()});
    const auto waiting = bus.bridge({"--source", "serial", "--device", "/dev/sonopose-absent"});
    REQUIRE(lines.wait_for([](const LineStatus& line) { return line.state == LineState::waiting; }));
    const bool is_known =
        statuses.wait_for([](const BeaconStatus& status) { return status.battery_v.has_value(); });
    CAPTURE(bridge->text(Stream::error), statuses.samples.size());
    REQUIRE(is_known);
    WHEN("the doctor runs") {
      const Result result = look_for("its battery is at 3.31 V", bus.domain_id(), {"--duration", "1"});
      CAPTURE(result.output, result.error);
      THEN("it reports the voltage, and the device") {
        CHECK(result.code == 1);
        CHECK_THAT(result.output, Contains("its battery is at 3.31 V"));
        CHECK_THAT(result.output, Contains("line /dev/sonopose-absent: its bridge waits for the device"));
      }
    }
  }
}

SCENARIO("the doctor finds two fusions of one strength, foreign endpoints, and other clocks") {
  GIVEN("a bridge, and two fusions of the same strength") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto first = bus.fusion();
    const auto second = bus.fusion();
    const auto bridge = bus.bridge({"--scenario", "rest"});
    REQUIRE(poses.wait_for_count(1));
    REQUIRE(poses.wait_for_writers(2));
    AND_GIVEN("a writer and a reader of poses with other QoS, and IMU samples of a clock that is 5 s ahead") {
      const auto participant = dds::ext::participant({.domain_id = bus.domain_id()});
      const dds::topic::Topic<sonopose_FusedPose> topic(participant, topics::pose.name);
      const dds::pub::DataWriter<sonopose_FusedPose> foreign_writer(dds::pub::Publisher(participant), topic);
      const dds::sub::DataReader<sonopose_FusedPose> foreign_reader(dds::sub::Subscriber(participant), topic);
      auto ahead = dds::topics::make_writer(participant, dds::qos::Provider(), topics::imu);
      std::jthread clock_ahead([&ahead](const std::stop_token& stop) {
        ImuSample imu;
        imu.address = 99;
        while (!stop.stop_requested()) {
          const auto now = std::chrono::system_clock::now().time_since_epoch();
          imu.sensor_time_ns =
              std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() + 5'000'000'000;
          imu.bridge_time_ns = imu.sensor_time_ns;
          ++imu.sequence;
          imu.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
          ahead.write(dds::topics::to_idl(imu));
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
      });
      WHEN("the doctor runs") {
        const Result result = look_for("with the same strength", bus.domain_id(), {"--duration", "1.2"});
        const std::string report = unwrapped(result.output);
        THEN("it finds the fusions, the QoS and the clock") {
          CAPTURE(result.output, result.error);
          CHECK(result.code == 1);
          CHECK_THAT(report, Contains("with the same strength"));
          const std::string here = "test_system_doctor (process " + std::to_string(getpid());
          CHECK_THAT(report, Contains("cannot receive from " + here));
          for (const auto* const fusion : {first.get(), second.get()}) {
            const std::string name = "sonopose-fusion (process " + std::to_string(fusion->pid());
            CHECK_THAT(report, Contains(name));
            CHECK(cannot_receive(report, here, name));
          }
          CHECK_THAT(report, Contains("the clock of the bridge's machine is about ") &&
                                 Contains(" ms ahead of the clock of this machine"));
        }
      }
    }
  }
}

}  // namespace sonopose::doctor_faults_test
