#include "dds/field_filler.hpp"
#include "dds/topics/field_lists.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/dds/topics/conversions.hpp>

#include <catch2/catch.hpp>

#include <limits>
#include <regex>
#include <set>
#include <string>
#include <tuple>

namespace sonopose::dds::test::conversions_test {

/// Every field has a unique value, so a forgotten field (zero) and a confused one (another's value) are
/// detected.
TEST_CASE("Every field of every native type survives the conversion to IDL and back") {
  Filler fill;
  SECTION("IMU sample") {
    ImuSample sample;
    fill.all(sample.address, sample.sequence, sample.sensor_time_ns, sample.bridge_time_ns,
             sample.angular_velocity_body_radps, sample.specific_force_body_mps2,
             sample.magnetic_field_body_t);
    sample.meaning = ImuMeaning::mean_since_last;
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.magnetic_field_body_t.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("ultrasonic fix") {
    UltrasonicFix sample;
    fill.all(sample.address, sample.sequence, sample.emission_time_ns, sample.received_time_ns,
             sample.position_world_m, sample.covariance_world_m2, sample.measured_delay_s, sample.flags,
             sample.point_body_m);
    sample.quality_percent = 87.5;  // a float on the wire
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.covariance_world_m2.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.quality_percent.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.measured_delay_s.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("pair heading") {
    PairHeading sample;
    fill.all(sample.address, sample.sequence, sample.emission_time_ns, sample.received_time_ns,
             sample.heading_world_rad, sample.valid, sample.std_rad, sample.flags);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("twist") {
    TwistSample sample;
    fill.all(sample.address, sample.sequence, sample.emission_time_ns, sample.received_time_ns,
             sample.velocity_body_mps, sample.velocity_std_mps, sample.angular_velocity_body_radps,
             sample.angular_velocity_std_radps, sample.axes);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("stationary beacon") {
    StationaryBeacon sample;
    fill.all(sample.address, sample.time_ns, sample.position_world_m);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.position_world_m.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("pose") {
    FusedPose sample;
    fill.all(sample.address, sample.sequence, sample.time_ns, sample.position_world_m, sample.q_body_to_world,
             sample.velocity_world_mps, sample.angular_velocity_body_radps, sample.acceleration_world_mps2,
             sample.gyro_bias_body_radps, sample.pose_covariance, sample.velocity_covariance, sample.trust,
             sample.since_valid_fix_s, sample.reset_counter, sample.status, sample.imu_sensor_time_ns,
             sample.imu_bridge_time_ns, sample.fusion_in_time_ns, sample.fusion_out_time_ns);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("fix report") {
    FixReport sample;
    fill.all(sample.address, sample.sequence, sample.emission_time_ns, sample.applied_time_ns,
             sample.position_world_m, sample.shifted_position_world_m, sample.innovation_world_m,
             sample.innovation_covariance_m2, sample.test_ratio, sample.hypothesis, sample.model,
             sample.weight, sample.trust, sample.jump_world_m, sample.velocity_change_world_mps,
             sample.yaw_change_rad, sample.flags);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.innovation_covariance_m2.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.test_ratio.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("estimate") {
    Estimate sample;
    fill.all(sample.address, sample.fusion_id, sample.time_ns, sample.gyro_bias_body_radps,
             sample.accelerometer_bias_body_mps2, sample.lever_arm_body_m, sample.delay_s, sample.fix_noise_m,
             sample.heading_noise_rad);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.gyro_bias_body_radps.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.accelerometer_bias_body_mps2.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.lever_arm_body_m.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.delay_s.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.fix_noise_m.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.heading_noise_rad.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("beacon status") {
    BeaconStatus sample;
    fill.all(sample.address, sample.time_ns, sample.battery_v, sample.rssi_dbm, sample.imu_rate_hz,
             sample.fix_rate_hz, sample.heading_rate_hz, sample.clock_offset_s, sample.clock_jitter_s,
             sample.frames, sample.crc_errors, sample.bytes_lost, sample.unknown_frames,
             sample.fixes_unavailable, sample.samples_rejected, sample.clock_resets, sample.other_bridges,
             sample.imu_deadlines_missed, sample.fix_deadlines_missed, sample.heading_deadlines_missed,
             sample.liveliness_lost, sample.readers_incompatible, sample.samples_unwritten,
             sample.samples_unrecorded);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.battery_v.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    sample.rssi_dbm.reset();
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("line status") {
    LineStatus sample;
    fill.all(sample.name, sample.bridge_id, sample.time_ns, sample.bytes, sample.frames, sample.crc_errors,
             sample.bytes_lost, sample.packets_refused, sample.text);
    sample.state = LineState::no_frames;
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("log line") {
    LogLine sample;
    fill.all(sample.host, sample.process_id, sample.number, sample.time_ns, sample.program, sample.text);
    sample.level = LogLevel::failure;
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("fusion status") {
    FusionStatus sample;
    fill.all(sample.address, sample.fusion_id, sample.time_ns, sample.strength, sample.imu_silent,
             sample.overloaded, sample.imu_samples, sample.fixes_used, sample.fixes_down_weighted,
             sample.fixes_rejected, sample.fixes_late, sample.headings, sample.velocities_used,
             sample.velocities_rejected, sample.velocities_unused, sample.events_lost,
             sample.events_duplicated, sample.samples_invalid, sample.imu_gaps, sample.reset_counter,
             sample.imu_deadlines_missed, sample.fix_deadlines_missed, sample.heading_deadlines_missed,
             sample.bridge_losses, sample.poses_late, sample.poses_skipped, sample.pose_deadlines_missed,
             sample.liveliness_lost, sample.samples_lost, sample.samples_rejected, sample.incompatible_qos,
             sample.poses_unwritten);
    sample.role = FusionRole::stalled;
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
  SECTION("truth") {
    TruthSample sample;
    fill.all(sample.address, sample.time_ns, sample.position_world_m, sample.q_body_to_world,
             sample.velocity_world_mps);
    CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  }
}

TEST_CASE("Every field of requests and replies about settings survives the conversion to IDL and back") {
  Filler fill;
  const std::vector<SettingAssignment> list{
      {"documented.drift.jump_alpha", "0.5"}, {"", ""}, {"mühle", "1 … 2"}};
  SECTION("request") {
    SettingsRequest request;
    fill.all(request.address, request.request_id, request.from_sequence);
    request.assignments = list;
    CHECK(topics::from_idl(topics::to_idl(request).sample()) == request);
    request.assignments.clear();
    CHECK(topics::from_idl(topics::to_idl(request).sample()) == request);
  }
  SECTION("reply") {
    SettingsReply reply;
    fill.all(reply.address, reply.request_id, reply.accepted, reply.from_sequence, reply.reason,
             reply.details);
    CHECK(topics::from_idl(topics::to_idl(reply)) == reply);
  }
  SECTION("effective settings") {
    EffectiveSettings settings;
    fill.all(settings.address, settings.time_ns, settings.from_sequence);
    settings.values = list;
    CHECK(topics::from_idl(topics::to_idl(settings).sample()) == settings);
  }
}

/// Counts the top-level members of a type by its descriptor's operations, one `DDS_OP_ADR` each.
int member_count(const dds_topic_descriptor_t& type) {
  int count = 0;
  const std::uint32_t* op = type.m_ops;
  while ((*op & DDS_OP_MASK) == DDS_OP_ADR) {
    ++count;
    switch (DDS_OP_TYPE(*op)) {
      case DDS_OP_VAL_BST:
      case DDS_OP_VAL_EXT:
      case DDS_OP_VAL_ARR:  // array of numbers
        op += 3;
        break;
      case DDS_OP_VAL_BSQ:
        op += 5;
        break;  // sequence of structs
      default:
        op += 2;
    }
  }
  REQUIRE((*op & DDS_OP_MASK) == DDS_OP_RTS);
  return count;
}

template <class Native>
int covered() {
  return topics::fields::idl_members(topics::fields::Pairs<Native>::list);
}

TEST_CASE("The lists of fields cover every member of the IDL types") {
  CHECK(covered<ImuSample>() == member_count(sonopose_ImuSample_desc));
  CHECK(covered<UltrasonicFix>() == member_count(sonopose_UltrasonicFix_desc));
  CHECK(covered<PairHeading>() == member_count(sonopose_PairHeading_desc));
  CHECK(covered<TwistSample>() == member_count(sonopose_TwistSample_desc));
  CHECK(covered<StationaryBeacon>() == member_count(sonopose_StationaryBeacon_desc));
  CHECK(covered<FusedPose>() == member_count(sonopose_FusedPose_desc));
  CHECK(covered<FixReport>() == member_count(sonopose_FixReport_desc));
  CHECK(covered<Estimate>() == member_count(sonopose_Estimate_desc));
  CHECK(covered<BeaconStatus>() == member_count(sonopose_BeaconStatus_desc));
  CHECK(covered<LineStatus>() == member_count(sonopose_LineStatus_desc));
  CHECK(covered<FusionStatus>() == member_count(sonopose_FusionStatus_desc));
  CHECK(covered<LogLine>() == member_count(sonopose_LogLine_desc));
  CHECK(covered<TruthSample>() == member_count(sonopose_TruthSample_desc));
  // plus the list of assignments
  CHECK(covered<SettingsRequest>() + 1 == member_count(sonopose_SettingsRequest_desc));
  CHECK(covered<SettingsReply>() == member_count(sonopose_SettingsReply_desc));
  CHECK(covered<EffectiveSettings>() + 1 == member_count(sonopose_EffectiveSettings_desc));
}

TEST_CASE("Texts and lists for other programs are bounded") {
  SECTION("a text for people is cut and marked") {
    SettingsReply reply;
    reply.reason = std::string(sonopose_MAX_REASON, 'x');
    CHECK(topics::from_idl(topics::to_idl(reply)).reason == reply.reason);
    reply.reason += 'x';
    CHECK(topics::from_idl(topics::to_idl(reply)).reason ==
          std::string(sonopose_MAX_REASON - 3, 'x') + "...");
    reply.details = std::string(sonopose_MAX_DETAILS - 4, 'x') + "ü and more";
    CHECK(topics::from_idl(topics::to_idl(reply)).details ==
          std::string(sonopose_MAX_DETAILS - 4, 'x') + "...");
  }
  SECTION("an assignment is never cut") {
    SettingsRequest request;
    request.assignments = {
        {std::string(sonopose_MAX_SETTING_KEY, 'k'), std::string(sonopose_MAX_SETTING_VALUE, 'v')}};
    CHECK(topics::from_idl(topics::to_idl(request).sample()) == request);
    request.assignments[0].value += 'v';
    CHECK_THROWS_WITH(topics::to_idl(request), Catch::Contains("129 bytes, more than the 128"));
    request.assignments.assign(sonopose_MAX_ASSIGNMENTS + 1, {"a", "b"});
    CHECK_THROWS_WITH(topics::to_idl(request), Catch::Contains("257 settings, more than the 256"));
  }
}

TEST_CASE("Every documented setting fits into its bounded types") {
  const std::string text = sonopose::test::read_text(SONOPOSE_SOURCE_DIR "/docs/settings.md");
  const std::regex key("`([a-z_]+(?:\\.[a-z_0-9]+)+)`");
  std::set<std::string> keys;
  for (std::sregex_iterator match(text.begin(), text.end(), key), end; match != end; ++match) {
    keys.insert((*match)[1]);
  }
  CHECK(keys.size() > 37);
  CHECK(keys.size() <= sonopose_MAX_ASSIGNMENTS);
  for (const std::string& each : keys) CHECK(each.size() <= sonopose_MAX_SETTING_KEY);
}

TEST_CASE("An enumerator of another version is read as the first one") {
  sonopose_FusionStatus status{};
  status.role = sonopose_ROLE_STALLED + 1;
  CHECK(topics::from_idl(status).role == FusionRole::sole);
  sonopose_ImuSample sample{};
  sample.meaning = 99;
  CHECK(topics::from_idl(sample).meaning == ImuMeaning::unknown);
}

// The order of vectors and quaternions, checked without converting back.
TEST_CASE("Axes, quaternion components and covariances go to the members of their names") {
  ImuSample sample;
  sample.angular_velocity_body_radps = {1, 2, 3};
  const sonopose_ImuSample imu = topics::to_idl(sample);
  CHECK(imu.angular_velocity.x == 1);
  CHECK(imu.angular_velocity.y == 2);
  CHECK(imu.angular_velocity.z == 3);
  FusedPose pose;
  pose.q_body_to_world = Quaterniond(0.5, 0.1, 0.2, 0.3);  // w, x, y, z
  pose.pose_covariance.set(5, 0, 7.0);
  const sonopose_FusedPose idl = topics::to_idl(pose);
  CHECK(idl.orientation.w == 0.5);
  CHECK(idl.orientation.x == 0.1);
  CHECK(idl.orientation.y == 0.2);
  CHECK(idl.orientation.z == 0.3);
  CHECK(idl.pose_covariance[0] < 0);  // negative: unknown
  CHECK(idl.pose_covariance[5] == 7.0);
  CHECK(idl.pose_covariance[20] < 0);
}

TEST_CASE("A quality that is zero is known, and one that is not a number is not") {
  sonopose_UltrasonicFix fix{};
  CHECK(topics::from_idl(fix).quality_percent == 0.0);
  fix.quality = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(topics::from_idl(fix).quality_percent);
}

TEST_CASE("The infinite age of a pose before its first fix survives") {
  FusedPose pose;
  pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  CHECK(topics::from_idl(topics::to_idl(pose)).since_valid_fix_s == pose.since_valid_fix_s);
}

}  // namespace sonopose::dds::test::conversions_test
