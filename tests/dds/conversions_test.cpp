#include "dds/field_filler.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <catch2/catch.hpp>

#include <limits>

namespace sonopose::dds::test {
namespace {

/// Both ways, in both directions: native → IDL → native and IDL → native → IDL, every field with a value of its own. A
/// field that one of the functions forgets is zero afterwards, and one that they mix up has another's value.
TEST_CASE("Every field of every sample survives the way to IDL and back") {
  SECTION("IMU sample") {
    Filler fill;
    ImuSample sample;
    fill.all(sample.address, sample.sequence, sample.sensor_time_ns, sample.bridge_time_ns,
             sample.angular_velocity_body_radps, sample.specific_force_body_mps2);
    sample.magnetic_field_body_t = fill.vector();
    CHECK(from_idl(to_idl(sample)) == sample);
    sample.magnetic_field_body_t.reset();
    CHECK(from_idl(to_idl(sample)) == sample);
    CHECK_FALSE(to_idl(sample).magnetic_field_valid);
  }
  SECTION("ultrasonic fix") {
    Filler fill;
    UltrasonicFix fix;
    fill.all(fix.address, fix.sequence, fix.emission_time_ns, fix.received_time_ns, fix.position_world_m,
             fix.flags);
    fix.quality_percent = 87.5;  // a float on the wire
    fix.measured_delay_s = fill.number();
    CHECK(from_idl(to_idl(fix)) == fix);
    fix.measured_delay_s.reset();
    CHECK(from_idl(to_idl(fix)) == fix);
    fix.quality_percent.reset();
    CHECK(from_idl(to_idl(fix)) == fix);
    CHECK(to_idl(fix).quality < 0);
    fix.quality_percent = 0.0;  // bad, but known
    CHECK(from_idl(to_idl(fix)) == fix);
  }
  SECTION("pair heading") {
    Filler fill;
    PairHeading heading;
    fill.all(heading.address, heading.sequence, heading.emission_time_ns, heading.received_time_ns,
             heading.heading_world_rad);
    heading.valid = true;
    CHECK(from_idl(to_idl(heading)) == heading);
    heading.valid = false;
    CHECK(from_idl(to_idl(heading)) == heading);
  }
  SECTION("truth") {
    Filler fill;
    TruthSample truth;
    fill.all(truth.address, truth.time_ns, truth.position_world_m, truth.q_body_to_world,
             truth.velocity_world_mps);
    const TruthSample back = from_idl(to_idl(truth));
    CHECK(back.address == truth.address);
    CHECK(back.time_ns == truth.time_ns);
    CHECK(back.position_world_m == truth.position_world_m);
    CHECK(back.q_body_to_world.coeffs() == truth.q_body_to_world.coeffs());
    CHECK(back.velocity_world_mps == truth.velocity_world_mps);
  }
}

TEST_CASE("Every field of what is said about settings survives the way to IDL and back") {
  Filler fill;
  const std::vector<SettingAssignment> list{{"drift.jump_alpha", "0.5"}, {"", ""}, {"mühle", "1 … 2"}};
  SECTION("request") {
    SettingsRequest request;
    fill.all(request.address, request.request_id, request.from_sequence);
    request.assignments = list;
    CHECK(from_idl(to_idl(request).sample()) == request);
    request.assignments.clear();
    CHECK(from_idl(to_idl(request).sample()) == request);
  }
  SECTION("reply") {
    SettingsReply reply;
    fill.all(reply.address, reply.request_id, reply.from_sequence);
    reply.accepted = true;
    reply.details = "7: event 812, 9: event 501";
    CHECK(from_idl(to_idl(reply).sample()) == reply);
    reply.accepted = false;
    reply.reason = "drift.jump_alpha = 2: out of range";
    CHECK(from_idl(to_idl(reply).sample()) == reply);
  }
  SECTION("what is in force") {
    EffectiveSettings settings;
    fill.all(settings.address, settings.time_ns, settings.from_sequence);
    settings.values = list;
    CHECK(from_idl(to_idl(settings).sample()) == settings);
  }
  SECTION("a text that a foreign writer left out is empty") {
    CHECK(from_idl(sonopose_SettingsReply{}).reason.empty());
    CHECK(from_idl(sonopose_SettingsReply{}).details.empty());
    CHECK(from_idl(sonopose_SettingsRequest{}).assignments.empty());
  }
}

// The vectors' and quaternions' order, seen from outside.
TEST_CASE("Axes and quaternion parts go where their names say") {
  ImuSample sample;
  sample.angular_velocity_body_radps = {1, 2, 3};
  const sonopose_ImuSample imu = to_idl(sample);
  CHECK(imu.angular_velocity.x == 1);
  CHECK(imu.angular_velocity.y == 2);
  CHECK(imu.angular_velocity.z == 3);
  FusedPose pose;
  pose.q_body_to_world = Quaterniond(0.5, 0.1, 0.2, 0.3);  // w, x, y, z
  const sonopose_FusedPose idl = to_idl(pose);
  CHECK(idl.orientation.w == 0.5);
  CHECK(idl.orientation.x == 0.1);
  CHECK(idl.orientation.y == 0.2);
  CHECK(idl.orientation.z == 0.3);
}

TEST_CASE("A quality that is no number is unknown") {
  sonopose_UltrasonicFix fix{};
  fix.quality = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(from_idl(fix).quality_percent);
}

TEST_CASE("A pose before its first fix keeps its infinite age") {
  FusedPose pose;
  pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  CHECK(from_idl(to_idl(pose)).since_valid_fix_s == pose.since_valid_fix_s);
}

}  // namespace
}  // namespace sonopose::dds::test
