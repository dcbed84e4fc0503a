/// The path from the arrival of a sample to its pose on the bus does not allocate.

#include "clocks/clocks.hpp"
#include "fusion/estimators_feeder.hpp"
#include "fusion/fusion_node.hpp"
#include "support/allocations.hpp"
#include "support/test_domain.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

namespace path_allocations_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::fusion::test;

/// Counts, and nothing else.
struct Counter final : dds::DataReaderListener<sonopose_FusedPose> {
  void on_data_available(dds::DataReader<sonopose_FusedPose>& reader) noexcept override {
    reader.try_take_each([this](const sonopose_FusedPose&, const dds::SampleInfo&) { ++poses; });
  }
  std::size_t poses = 0;
};

SCENARIO("the path from a sample to its pose allocates nothing") {
  // In one process the fusion's listener runs on the thread that writes: all of its work falls into the
  // write.
  for (const bool standing_by : {false, true}) {
    GIVEN(std::string("a fusion") + (standing_by ? " in a standby pair" : "")) {
      const sonopose::test::TestDomain domain;
      const dds::DomainOptions options{.domain_id = domain.id()};
      FusionOptions fusion{.domain = options, .qos_file = {}, .config = {}, .addresses = {}, .standby = {}};
      if (standing_by) fusion.standby = {.strength = 5, .warm_up_s = 0.5};
      const FusionNode node(fusion);
      const dds::DomainParticipant participant(options);
      const dds::qos::Provider qos;
      auto imu_writer = dds::topics::make_writer(participant, qos, dds::topics::imu);
      auto fix_writer = dds::topics::make_writer(participant, qos, dds::topics::fix);
      auto heading_writer = dds::topics::make_writer(participant, qos, dds::topics::heading);
      Counter counter;
      const auto reader = dds::topics::make_reader(participant, qos, dds::topics::pose, &counter);
      const auto write = [&](const Event& event) {
        if (const auto* imu = std::get_if<ImuSample>(&event)) {
          ImuSample sent = *imu;
          sent.bridge_time_ns = clocks::steady_now().ns;  // else a pause of this test looks like late samples
          imu_writer.write(dds::topics::to_idl(sent));
        }
        if (const auto* fix = std::get_if<UltrasonicFix>(&event)) fix_writer.write(dds::topics::to_idl(*fix));
        if (const auto* heading = std::get_if<PairHeading>(&event)) {
          heading_writer.write(dds::topics::to_idl(*heading));
        }
      };
      const auto events = walk(7, 5.0);
      const std::size_t settled = events.size() / 2;
      const std::size_t at_first = sonopose::test::allocations();
      for (std::size_t i = 0; i < settled; ++i) write(events[i]);
      CHECK(sonopose::test::allocations() > at_first);  // the engine: so they are counted
      const std::size_t poses_before = counter.poses;
      const std::size_t before = sonopose::test::allocations();
      for (std::size_t i = settled; i < events.size(); ++i) write(events[i]);
      const std::size_t allocated = sonopose::test::allocations() - before;
      THEN("poses came, and nothing was allocated") {
        CHECK(counter.poses - poses_before > 200);
        CHECK(allocated == 0);
      }
    }
  }
}

}  // namespace path_allocations_test
