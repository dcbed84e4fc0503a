#include "json/json.hpp"

#include "support/matches.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace sonopose::json_test {

using namespace sonopose::json;

/// Names of a struct's fields in sonopose.idl.
std::vector<std::string> idl_fields(const std::string& type) {
  const std::string text =
      test::replace_matches(test::read_text(SONOPOSE_SOURCE_DIR "/idl/sonopose.idl"), "//[^\n]*", "");
  const std::size_t begin = text.find("struct " + type + " {");
  REQUIRE(begin != std::string::npos);
  const std::string body = text.substr(begin, text.find('}', begin) - begin);
  std::vector<std::string> names;
  for (const auto& field : test::all_matches(body, R"((\w+)(\[\d+\])?\s*;)")) names.push_back(field[1]);
  return names;
}

template <class Sample>
std::vector<std::string> json_fields(const Sample& sample) {
  const auto json = nlohmann::ordered_json::parse(json_of(sample));
  std::vector<std::string> names;
  for (const auto& entry : json.items()) names.push_back(entry.key());
  return names;
}

TEST_CASE("a sample has the fields of the IDL, in their order") {
  CHECK(json_fields(sonopose_FusedPose{}) == idl_fields("FusedPose"));
  CHECK(json_fields(sonopose_ImuSample{}) == idl_fields("ImuSample"));
  CHECK(json_fields(sonopose_UltrasonicFix{}) == idl_fields("UltrasonicFix"));
  CHECK(json_fields(sonopose_FixReport{}) == idl_fields("FixReport"));
  CHECK(json_fields(sonopose_FusionStatus{}) == idl_fields("FusionStatus"));
  CHECK(json_fields(sonopose_BeaconStatus{}) == idl_fields("BeaconStatus"));
  CHECK(json_fields(sonopose_LineStatus{}) == idl_fields("LineStatus"));
  CHECK(json_fields(sonopose_LogLine{}) == idl_fields("LogLine"));
  CHECK(json_fields(sonopose_EffectiveSettings{}) == idl_fields("EffectiveSettings"));
}

SCENARIO("values of every kind are JSON") {
  GIVEN("a pose with numbers that JSON cannot express") {
    sonopose_FusedPose pose{};
    pose.address = 7;
    pose.event_sequence = std::numeric_limits<std::uint64_t>::max();
    pose.time = 1'700'000'000'123'456'789;
    pose.position = {1.5, std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()};
    pose.since_valid_fix = std::numeric_limits<double>::infinity();
    pose.trust = 1.0;
    pose.pose_covariance[20] = 1e-300;
    const auto json = nlohmann::json::parse(json_of(pose));
    THEN("those are null, and all others read back to the same bits") {
      CHECK(json["address"] == 7);
      CHECK(json["event_sequence"] == std::numeric_limits<std::uint64_t>::max());
      CHECK(json["time"] == 1'700'000'000'123'456'789);
      CHECK(json["position"]["x"] == 1.5);
      CHECK(json["position"]["y"].is_null());
      CHECK(json["position"]["z"].is_null());
      CHECK(json["since_valid_fix"].is_null());
      CHECK(json["trust"].is_number_float());
      CHECK(json["pose_covariance"].size() == 21);
      CHECK(json["pose_covariance"][20] == 1e-300);
    }
  }
  GIVEN("texts with quotes, control characters and bytes that are no UTF-8") {
    sonopose_LineStatus line{};
    std::strcpy(line.name, "/dev/\"tty\"\n");
    std::strcpy(line.text, "no \xFF bytes");
    const std::string text = json_of(line);
    THEN("they stay one line") {
      CHECK(text.find('\n') == std::string::npos);
      CHECK(nlohmann::json::parse(text)["name"] == "/dev/\"tty\"\n");
      CHECK(nlohmann::json::parse(text)["text"].get<std::string>().starts_with("no "));
    }
  }
  GIVEN("settings, which are a sequence of structs") {
    std::array<sonopose_SettingAssignment, 2> values{};
    std::strcpy(values[1].key, "fusion.engine");
    std::strcpy(values[1].value, "kalman");
    sonopose_EffectiveSettings settings{};
    settings.values._length = 2;
    settings.values._buffer = values.data();
    THEN("they are an array of objects") {
      const auto json = nlohmann::json::parse(json_of(settings));
      CHECK(json["values"].size() == 2);
      CHECK(json["values"][1]["key"] == "fusion.engine");
      CHECK(json["values"][1]["value"] == "kalman");
    }
  }
}

}  // namespace sonopose::json_test
