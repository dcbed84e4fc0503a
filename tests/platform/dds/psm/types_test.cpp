/// Classes of the IDL types, as the generator of cyclonedds-cxx makes them.

#include "platform/dds/psm/psm_fixture.hpp"
#include "sonopose.hpp"

#include <catch2/catch.hpp>

#include <limits>

namespace psm_types_test {

using namespace psm_fixture;
using psm_test::Mode;
using psm_test::Part;

Sample full_sample() {
  Sample full(4, "north", "12345678", Mode::DONE, true, 200, 'x', {{{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}},
              Part(5, "part"), {Part(1, "a"), Part(2, "")}, {1, -2, 3}, {true, false, true},
              {"one", "", "three"}, {Part(7, "seven")});
  return full;
}

SCENARIO("a sample arrives with the same values") {
  Bus bus;
  bus.writer.write(full_sample());
  bus.writer.write(sample(8));  // empty, after a full one
  const auto samples = bus.reader.take();
  REQUIRE((samples.length() == 2));
  CHECK((samples.begin()->data() == full_sample()));
  CHECK(((samples.begin() + 1)->data() == sample(8)));
}

SCENARIO("accessors set and return fields") {
  Sample sample;
  CHECK((sample == Sample()));
  CHECK((sample.mode() == Mode::IDLE));
  CHECK((sample.matrix()[1][2] == 0.0));
  sample.matrix()[1][2] = 5.0;
  sample.part().text("moved");
  sample.numbers().push_back(3);
  sample.mode() = Mode::BUSY;
  const Sample copy = sample;
  CHECK((copy.matrix()[1][2] == 5.0));
  CHECK((copy.part().text() == "moved"));
  CHECK((copy.numbers() == psm_test::Numbers{3}));
  CHECK((copy.mode() == Mode::BUSY));
  CHECK((copy != Sample()));
  CHECK((psm_test::GREETING == "hi"));
  CHECK((psm_test::LOW == std::numeric_limits<std::int32_t>::min()));
  CHECK((psm_test::LOWEST == std::numeric_limits<std::int64_t>::min()));
  CHECK((psm_test::LARGE == std::numeric_limits<std::uint64_t>::max()));
}

SCENARIO("the native types are such classes") {
  Bus bus;
  const dds::topic::Topic<sonopose::FusedPose> topic(bus.participant, "sonopose/pose");
  CHECK((topic.type_name() == "sonopose::FusedPose"));
  dds::pub::DataWriter<sonopose::FusedPose> writer(bus.publisher, topic);
  dds::sub::DataReader<sonopose::FusedPose> reader(bus.subscriber, topic);
  REQUIRE(wait_until([&] { return writer.publication_matched_status().current_count() == 1; }));
  sonopose::FusedPose pose;
  pose.address(7);
  pose.position(sonopose::Vector3(1.0, 2.0, 3.0));
  pose.pose_covariance()[20] = 0.25;
  pose.status(sonopose::STATUS_STALE);
  writer.write(pose);
  const auto samples = reader.take();
  REQUIRE((samples.length() == 1));
  CHECK((samples.begin()->data() == pose));
  CHECK((samples.begin()->data().position().y() == 2.0));
}

}  // namespace psm_types_test
