/// The reset command.

#include "support/bus.hpp"

#include <algorithm>

namespace sonopose::reset_test {

using namespace sonopose::test;
namespace topics = dds::topics;

class Commander {
public:
  explicit Commander(const Bus& bus)
      : participant_(dds::ext::participant({.domain_id = bus.domain_id()})),
        writer_(dds::topics::make_writer(participant_, dds::qos::Provider(), topics::reset)) {}

  bool wait_for_fusion() {
    return wait_for_status(writer_, dds::core::status::StatusMask::publication_matched(),
                           [&] { return writer_.publication_matched_status().current_count() == 1; });
  }

  void reset(BeaconAddress address, std::uint64_t request_id) {
    writer_.write(sonopose_ResetCommand{.address = address, .request_id = request_id});
  }

private:
  dds::domain::DomainParticipant participant_;
  dds::pub::DataWriter<sonopose_ResetCommand> writer_;
};

/// Predicate for a pose of `address` after `count` resets.
auto reset_to(BeaconAddress address, std::uint32_t count) {
  return [=](const FusedPose& pose) { return pose.address == address && pose.reset_counter == count; };
}

auto ready(BeaconAddress address) {
  return [=](const FusedPose& pose) {
    return pose.address == address && (pose.status & status_initialising) == 0U;
  };
}

SCENARIO("a reset re-initialises the engine of one beacon only") {
  GIVEN("a fusion that serves beacons 7 and 8") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto seven = bus.bridge({"--scenario", "rest", "--address", "7"});
    const auto eight = bus.bridge({"--scenario", "rest", "--address", "8"});
    Commander commander(bus);
    REQUIRE(commander.wait_for_fusion());
    REQUIRE(poses.wait_for(ready(7)));
    REQUIRE(poses.wait_for(ready(8)));
    WHEN("beacon 7 is reset") {
      const std::size_t since = poses.samples.size();
      commander.reset(7, 1);
      THEN("its counter increases and it initialises again; beacon 8 continues") {
        REQUIRE(poses.wait_for(reset_to(7, 1), since));
        const auto first = std::find_if(poses.samples.begin(), poses.samples.end(), reset_to(7, 1));
        CHECK((first->status & status_initialising) != 0U);
        REQUIRE(poses.wait_for([](const FusedPose& pose) { return reset_to(7, 1)(pose) && ready(7)(pose); },
                               since));
        for (std::size_t i = since; i < poses.samples.size(); ++i) {
          const FusedPose& pose = poses.samples[i];
          if (pose.address != 8) continue;
          REQUIRE(pose.reset_counter == 0);
          REQUIRE(ready(8)(pose));
        }
      }
    }
    WHEN("a request is repeated, then a new one for all beacons follows") {
      commander.reset(7, 1);
      REQUIRE(poses.wait_for(reset_to(7, 1)));
      commander.reset(7, 1);
      commander.reset(all_beacons, 2);
      REQUIRE(poses.wait_for(reset_to(8, 1)));
      const std::size_t since = poses.samples.size();
      THEN("the repetition has no effect, and all beacons are reset") {
        REQUIRE(poses.wait_for([](const FusedPose& pose) { return pose.address == 7; }, since));
        const auto last = std::find_if(poses.samples.rbegin(), poses.samples.rend(),
                                       [](const FusedPose& pose) { return pose.address == 7; });
        CHECK(last->reset_counter == 2);
      }
    }
  }
}

}  // namespace sonopose::reset_test
