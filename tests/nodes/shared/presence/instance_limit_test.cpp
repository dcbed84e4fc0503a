#include "presence/instance_limit.hpp"

#include "presence/beacon_admission.hpp"

#include <catch2/catch.hpp>

#include <cstring>

namespace instance_limit_test {

using namespace sonopose;
using namespace sonopose::presence;

constexpr BeaconAddress beacon = 7;
constexpr std::size_t max_fusions = Instance<sonopose_FusionStatus>::max_at_a_time;

sonopose_FusionStatus status_of(BeaconAddress address, std::uint64_t fusion_id) {
  sonopose_FusionStatus status{};
  status.address = address;
  status.fusion_id = fusion_id;
  return status;
}

SCENARIO("the first fusions of a beacon are accepted, until they are gone") {
  InstanceLimit<sonopose_FusionStatus> limit;
  for (std::uint64_t id = 1; id <= max_fusions; ++id) REQUIRE(limit.accepts(status_of(beacon, id)));
  CHECK_FALSE(limit.refusals());
  CHECK_FALSE(limit.accepts(status_of(beacon, max_fusions + 1)));
  CHECK(limit.accepts(status_of(beacon, 1)));
  CHECK(limit.accepts(status_of(beacon + 1, max_fusions + 1)));
  CHECK_THAT(limit.refusals().value_or(""),
             Catch::Contains("1 sample is ignored: the limit is 8 fusions of a beacon at a time"));
  CHECK_FALSE(limit.refusals());
  limit.forget(status_of(beacon, 1));
  CHECK(limit.accepts(status_of(beacon, max_fusions + 1)));
  CHECK_FALSE(limit.accepts(status_of(beacon, 1)));
}

SCENARIO("the fusions that were never accepted are counted once each") {
  InstanceLimit<sonopose_FusionStatus> limit;
  for (std::uint64_t id = 1; id <= max_fusions; ++id) REQUIRE(limit.accepts(status_of(beacon, id)));
  CHECK_FALSE(limit.warning());
  for (int sample = 0; sample < 100; ++sample) {
    for (std::uint64_t id = 101; id <= 103; ++id) CHECK_FALSE(limit.accepts(status_of(beacon, id)));
  }
  CHECK_THAT(limit.warning().value_or(""),
             Catch::Contains("3 fusions were not observed: the limit is 8 fusions of a beacon at a time"));
  WHEN("places become free for two of them") {
    for (std::uint64_t id = 1; id <= 2; ++id) limit.forget(status_of(beacon, id));
    for (std::uint64_t id = 101; id <= 102; ++id) CHECK(limit.accepts(status_of(beacon, id)));
    THEN("one is left") {
      CHECK_THAT(limit.warning().value_or(""), Catch::StartsWith("1 fusion was not observed"));
    }
  }
}

SCENARIO("a fusion that was observed and is refused when it returns was observed") {
  InstanceLimit<sonopose_FusionStatus> limit;
  for (std::uint64_t id = 1; id <= max_fusions; ++id) REQUIRE(limit.accepts(status_of(beacon, id)));
  limit.forget(status_of(beacon, 1));
  REQUIRE(limit.accepts(status_of(beacon, max_fusions + 1)));
  CHECK_FALSE(limit.accepts(status_of(beacon, 1)));
  CHECK_FALSE(limit.warning());
}

SCENARIO("fusions that come and go without end are bounded, and those that return are not") {
  InstanceLimit<sonopose_FusionStatus> limit;
  const auto visit = [&limit](std::uint64_t id) {
    const bool accepted = limit.accepts(status_of(beacon, id));
    limit.forget(status_of(beacon, id));
    return accepted;
  };
  for (std::uint64_t id = 1; id <= limit.max_ever; ++id) REQUIRE(visit(id));
  CHECK_FALSE(visit(limit.max_ever + 1));
  CHECK(visit(1));
}

SCENARIO("fusions of a beacon that is not admitted take no place") {
  BeaconAdmission admission(AddressSet::parse("7"), 1);
  InstanceLimit<sonopose_FusionStatus> limit(&admission);
  CHECK_FALSE(limit.accepts(status_of(8, 1)));
  CHECK(limit.accepts(status_of(7, 1)));
  CHECK_FALSE(limit.refusals());
}

SCENARIO("lines differ by name and bridge, and the first ones are accepted") {
  InstanceLimit<sonopose_LineStatus> limit;
  sonopose_LineStatus line{};
  for (line.bridge_id = 1; line.bridge_id <= 256; ++line.bridge_id) REQUIRE(limit.accepts(line));
  CHECK_FALSE(limit.accepts(line));
  line.bridge_id = 1;
  CHECK(limit.accepts(line));
  std::strcpy(line.name, "/dev/ttyACM0");
  CHECK_FALSE(limit.accepts(line));
}

SCENARIO("processes that log differ by machine and number, and the first ones are accepted") {
  InstanceLimit<sonopose_LogLine> limit;
  sonopose_LogLine line{};
  for (line.process_id = 1; line.process_id <= 64; ++line.process_id) REQUIRE(limit.accepts(line));
  CHECK_FALSE(limit.accepts(line));
  line.process_id = 1;
  CHECK(limit.accepts(line));
  std::strcpy(line.host, "another");
  CHECK_FALSE(limit.accepts(line));
  std::strcpy(line.host, "");
  limit.forget(line);
  std::strcpy(line.host, "another");
  CHECK(limit.accepts(line));
}

}  // namespace instance_limit_test
