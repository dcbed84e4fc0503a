/// Forged samples of the right types with values that no honest process sends. Under the sanitizers,
/// undefined behaviour ends a process.

#include "clocks/clocks.hpp"
#include "support/bus.hpp"
#include "support/pose_tap.hpp"
#include "system/doctor_run.hpp"

#include <array>
#include <csignal>
#include <limits>

namespace sonopose::absurd_samples_test {

using namespace sonopose::test;
namespace topics = dds::topics;

constexpr BeaconAddress healthy = 7;
constexpr BeaconAddress absurd = 8;

/// Time `i` of a series in which extremes are adjacent, with ordinary times in between.
TimeNs time(std::size_t i) {
  using Limits = std::numeric_limits<TimeNs>;
  const TimeNs now_ns = clocks::host_now();
  const std::array values{Limits::min(),     Limits::max(), now_ns, TimeNs{-1},
                          Limits::min() + 1, TimeNs{0},     now_ns};
  return values[i % values.size()];
}

double number(std::size_t i) {
  using Limits = std::numeric_limits<double>;
  const std::array values{
      Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), Limits::max(), -Limits::max(), 0.0, 1.0,
      Limits::denorm_min()};
  return values[i % values.size()];
}

sonopose_Vector3 vector(std::size_t i) {
  return {number(i), number(i / 3), number(i / 5)};
}

std::uint64_t count(std::size_t i) {
  return i % 3 == 0 ? std::numeric_limits<std::uint64_t>::max() : i;
}

/// Writes all of them, to the topics of measurements, poses and statuses.
class Forger {
public:
  explicit Forger(const Bus& bus) : participant_(dds::ext::participant({.domain_id = bus.domain_id()})) {}

  void write(std::size_t i) {
    write_inputs(i);
    write_outputs(i);
  }

private:
  void write_inputs(std::size_t i) {
    sonopose_ImuSample imu{};
    imu.address = absurd;
    imu.event_sequence = i % 7 == 6 ? count(i) : i + 1;
    imu.sensor_time = time(i);
    imu.bridge_time = time(i / 2);
    imu.angular_velocity = vector(i);
    imu.specific_force = vector(i / 2);
    imu.meaning = static_cast<std::uint32_t>(i);
    imu_.write(imu);
    sonopose_UltrasonicFix fix{};
    fix.address = absurd;
    fix.event_sequence = count(i);
    fix.emission_time = time(i / 3);
    fix.received_time = time(i);
    fix.position = vector(i);
    fix.covariance_valid = true;
    fix.covariance[0] = number(i);
    fix.quality = static_cast<float>(number(i / 2));
    fix.measured_delay = number(i / 7);
    fix.measured_delay_valid = true;
    fix_.write(fix);
    sonopose_PairHeading heading{};
    heading.address = absurd;
    heading.event_sequence = count(i + 1);
    heading.emission_time = time(i / 2);
    heading.received_time = time(i / 3);
    heading.heading = number(i);
    heading.valid = true;
    heading_.write(heading);
  }

  void write_outputs(std::size_t i) {
    sonopose_FusedPose pose{};
    pose.address = absurd;
    pose.event_sequence = count(i);
    pose.time = time(i);
    pose.position = vector(i);
    pose.orientation = {number(i), number(i / 2), number(i / 3), number(i / 4)};
    pose.velocity = vector(i / 2);
    pose.since_valid_fix = number(i);
    pose.status = static_cast<std::uint32_t>(count(i));
    pose.imu_sensor_time = time(i / 2);
    pose.imu_bridge_time = time(i / 3);
    pose.fusion_in_time = time(i / 5);
    pose.fusion_out_time = time(i / 7);
    pose_.write(pose);
    sonopose_BeaconStatus beacon{};
    beacon.address = absurd;
    beacon.time = time(i);
    beacon.imu_rate = beacon.clock_offset = number(i);
    beacon.frames = beacon.crc_errors = count(i);
    beacon_status_.write(beacon);
    sonopose_FusionStatus fusion{};
    fusion.address = absurd;
    fusion.fusion_id = i % 5;
    fusion.time = time(i);
    fusion.role = static_cast<std::uint32_t>(count(i));
    fusion.strength = std::numeric_limits<std::int32_t>::max();
    fusion.events_lost = count(i);
    fusion_status_.write(fusion);
    sonopose_TruthSample truth{};
    truth.address = absurd;
    truth.time = time(i / 2);
    truth.position = vector(i);
    truth_.write(truth);
  }

  template <class T>
  dds::pub::DataWriter<T> writer(const topics::Entry<T>& entry) const {
    return topics::make_writer(participant_, dds::qos::Provider(), entry);
  }

  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<sonopose_ImuSample> imu_ = writer(topics::imu);
  dds::pub::DataWriter<sonopose_UltrasonicFix> fix_ = writer(topics::fix);
  dds::pub::DataWriter<sonopose_PairHeading> heading_ = writer(topics::heading);
  dds::pub::DataWriter<sonopose_FusedPose> pose_ = writer(topics::pose);
  dds::pub::DataWriter<sonopose_BeaconStatus> beacon_status_ = writer(topics::beacon_status);
  dds::pub::DataWriter<sonopose_FusionStatus> fusion_status_ = writer(topics::fusion_status);
  dds::pub::DataWriter<sonopose_TruthSample> truth_ = writer(topics::truth);
};

SCENARIO("samples with absurd times, numbers and counters end no process and disturb no other beacon") {
  GIVEN("a bridge, two fusions, a monitor and a relay that serve a beacon") {
    const Bus bus;
    const auto first = bus.fusion({"--standby-strength", "100", "--warm-up", "0.2"});
    const auto second = bus.fusion({"--standby-strength", "50", "--warm-up", "0.2"});
    const auto monitor = bus.monitor({"--json"});
    const auto relay = bus.ros2();
    const auto bridge = bus.bridge({"--address", std::to_string(healthy)});
    const PoseTap tap(bus);
    const auto is_healthy = [](const TappedPose& tapped) { return tapped.pose.address == healthy; };
    REQUIRE(tap.wait_for(is_healthy, 0));
    WHEN("such samples of another beacon come on every topic") {
      Forger forger(bus);
      for (std::size_t i = 0; i < 500; ++i) {
        forger.write(i);
        if (i % 10 == 9) REQUIRE(tap.wait_for(is_healthy, tap.count()));
      }
      THEN("the poses of the beacon go on, a doctor reports, and every process ends as asked") {
        const Result doctor = look_for("beacon 7: ", bus.domain_id(), {"--duration", "0.5"});
        CHECK_THAT(doctor.output, Catch::Contains("beacon 7: "));
        const auto pose = tap.wait_for(is_healthy, tap.count());
        REQUIRE(pose);
        CHECK(pose->pose.position_world_m.allFinite());
        for (Process* process : {bridge.get(), relay.get(), monitor.get(), second.get(), first.get()}) {
          CHECK(process->end_by(SIGINT).code == 0);
        }
      }
    }
  }
}

}  // namespace sonopose::absurd_samples_test
