/// The path from the arrival of a sample to its pose on the bus does not allocate.

#include "clocks/clocks.hpp"
#include "fusion/estimators_feeder.hpp"
#include "fusion/fusion_node.hpp"
#include "support/allocations.hpp"
#include "support/test_domain.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <thread>

namespace sonopose::path_allocations_test {

using namespace sonopose::fusion;
using namespace sonopose::fusion::test;

/// Counts poses without allocating.
struct Counter final : dds::sub::NoOpDataReaderListener<sonopose_FusedPose> {
  void on_data_available(dds::sub::DataReader<sonopose_FusedPose>& reader) noexcept override {
    dds::ext::try_take_each(reader, [this](const sonopose_FusedPose& pose, const dds::sub::SampleInfo&) {
      ++poses;
      latest = pose.event_sequence;
    });
  }

  /// Waits for the pose of the last IMU sample of these events, since a fusion processes late samples on a
  /// separate thread. The pose may never come, because an overloaded fusion skips poses.
  void wait_for(std::span<const Event> events) const {
    const auto last = std::find_if(events.rbegin(), events.rend(), [](const Event& event) {
      return std::holds_alternative<ImuSample>(event);
    });
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (latest < sequence_of(*last) && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }

  std::atomic<std::size_t> poses = 0;
  std::atomic<std::uint64_t> latest = 0;
};

/// Waits for the settings of a new beacon, which another thread of the fusion publishes with allocations.
void wait_for_settings(dds::sub::DataReader<sonopose_EffectiveSettings>& reader, BeaconAddress address) {
  dds::sub::cond::ReadCondition has_data(reader, dds::sub::status::DataState::any());
  dds::core::cond::WaitSet waitset;
  waitset += has_data;
  bool came = false;
  while (!came) {
    REQUIRE(dds::ext::wait(waitset, std::chrono::minutes(3)));
    dds::ext::take_each(reader, [&](const sonopose_EffectiveSettings& sample, const dds::sub::SampleInfo&) {
      came = came || sample.address == address;
    });
  }
}

SCENARIO("the path from a sample to its pose allocates nothing") {
  // Within one process the fusion's listener runs on the writing thread, so all of its work is part of the
  // write.
  for (const bool standing_by : {false, true}) {
    GIVEN(std::string("a fusion") + (standing_by ? " in a standby pair" : "")) {
      const sonopose::test::TestDomain domain;
      const dds::DomainOptions options{.domain_id = domain.id()};
      FusionOptions fusion{.domain = options, .qos_file = {}, .config = {}, .addresses = {}, .standby = {}};
      if (standing_by) fusion.standby = {.strength = 5, .warm_up_s = 0.5};
      const FusionNode node(fusion);
      const auto participant = dds::ext::participant(options);
      const dds::qos::Provider qos;
      auto imu_writer = dds::topics::make_writer(participant, qos, dds::topics::imu);
      auto fix_writer = dds::topics::make_writer(participant, qos, dds::topics::fix);
      auto heading_writer = dds::topics::make_writer(participant, qos, dds::topics::heading);
      Counter counter;
      const auto reader = dds::topics::make_reader(participant, qos, dds::topics::pose, &counter);
      auto settings = dds::topics::make_reader(participant, qos, dds::topics::settings);
      const auto write = [&](const Event& event) {
        if (const auto* imu = std::get_if<ImuSample>(&event)) {
          ImuSample sent = *imu;
          sent.bridge_time_ns =
              clocks::steady_now().ns;  // otherwise a pause of this test would make samples late
          imu_writer.write(dds::topics::to_idl(sent));
        }
        if (const auto* fix = std::get_if<UltrasonicFix>(&event)) fix_writer.write(dds::topics::to_idl(*fix));
        if (const auto* heading = std::get_if<PairHeading>(&event)) {
          heading_writer.write(dds::topics::to_idl(*heading));
        }
      };
      const auto events = walk(7, 15.0);
      const std::size_t settled = events.size() / 6;
      const std::size_t at_first = sonopose::test::allocations();
      for (std::size_t i = 0; i < settled; ++i) write(events[i]);
      counter.wait_for(std::span(events).first(settled));
      wait_for_settings(settings, address_of(events.front()));
      CHECK(sonopose::test::allocations() > at_first);  // the engine allocates, so counting works
      const std::size_t poses_before = counter.poses;
      // On a busy machine late samples cause log lines, which allocate. The path would in each round.
      std::size_t allocated = 1;
      for (std::size_t i = settled; allocated > 0 && i + settled <= events.size();) {
        const std::size_t before = sonopose::test::allocations();
        const auto round = std::span(events).subspan(i, settled);
        for (const Event& event : round) write(event);
        counter.wait_for(round);
        allocated = sonopose::test::allocations() - before;
        i += settled;
      }
      THEN("poses came, and nothing was allocated") {
        CHECK(counter.poses > poses_before);  // a busy machine may lose samples
        CHECK(allocated == 0);
      }
    }
  }
}

}  // namespace sonopose::path_allocations_test
