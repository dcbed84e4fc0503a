#include "dds/field_filler.hpp"
#include "dds/topics/field_lists.hpp"
#include "support/matches.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/idl_types.hpp>

#include <catch2/catch.hpp>

#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace sonopose::dds::test::conversions_test {

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

/// Number of IDL members that the list of fields covers.
template <class Native>
int covered() {
  return topics::fields::idl_members(topics::fields::Pairs<Native>::list);
}

using Natives =
    std::tuple<ImuSample, UltrasonicFix, PairHeading, TwistSample, StationaryBeacon, FusedPose, FixReport,
               Estimate, BeaconStatus, LineStatus, LogLine, FusionStatus, TruthSample, SettingsReply>;

/// Every field has a unique value, so a forgotten field (zero) and a confused one (another's value) are
/// detected.
TEMPLATE_LIST_TEST_CASE("Every field of a native type survives the conversion to IDL and back", "", Natives) {
  using Pairs = topics::fields::Pairs<TestType>;
  CHECK(covered<TestType>() == member_count(TopicTraits<typename Pairs::I>::descriptor()));
  const auto for_each_pair = [](const auto& use) {
    std::apply([&](const auto&... pair) { (use(pair), ...); }, Pairs::list);
  };
  Filler fill;
  TestType sample;
  for_each_pair([&](const auto& pair) {
    auto& field = sample.*pair.native;
    const bool is_new = field == TestType().*pair.native;  // no other pair has filled it
    CHECK(is_new);
    if constexpr (requires { pair.last; }) {
      field = pair.last;
    } else {
      fill.all(field);
    }
  });
  CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
  for_each_pair([&](const auto& pair) {
    if constexpr (requires { (sample.*pair.native).reset(); }) {
      (sample.*pair.native).reset();
      CHECK(topics::from_idl(topics::to_idl(sample)) == sample);
    }
  });
}

TEST_CASE("Every field of lists of settings survives the conversion to IDL and back") {
  Filler fill;
  const std::vector<SettingAssignment> list{
      {"documented.drift.jump_alpha", "0.5"}, {"", ""}, {"mühle", "1 … 2"}};
  SECTION("request") {
    CHECK(covered<SettingsRequest>() + 1 == member_count(sonopose_SettingsRequest_desc));  // plus the list
    SettingsRequest request;
    fill.all(request.address, request.request_id, request.from_sequence);
    request.assignments = list;
    CHECK(topics::from_idl(topics::to_idl(request).sample()) == request);
    request.assignments.clear();
    CHECK(topics::from_idl(topics::to_idl(request).sample()) == request);
  }
  SECTION("effective settings") {
    CHECK(covered<EffectiveSettings>() + 1 == member_count(sonopose_EffectiveSettings_desc));
    EffectiveSettings settings;
    fill.all(settings.address, settings.time_ns, settings.from_sequence);
    settings.values = list;
    CHECK(topics::from_idl(topics::to_idl(settings).sample()) == settings);
  }
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
  std::set<std::string> keys;
  for (const auto& match : sonopose::test::all_matches(text, R"(`([a-z_]+(?:\.[a-z_0-9]+)+)`)")) {
    keys.insert(match[1]);
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
