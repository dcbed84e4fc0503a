/// A change of settings at a given event.

#include "recording/log_folder.hpp"
#include "support/bits.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace sonopose::settings_at_event_test {

using namespace sonopose::test;
using Catch::Contains;
namespace topics = dds::topics;

SCENARIO("a change at a given event gives poses that are bit-identical to the replay") {
  GIVEN("a log, and the poses of an engine whose settings change before event 1000") {
    const Bus bus;
    const TemporaryFolder folder;
    REQUIRE(bus.bridge({"--source", "sim", "--rate", "0", "--duration", "20", "--record",
                        (folder / "log").string()})
                ->wait_for_exit() == 0);
    constexpr std::uint64_t from = 1000;
    const Arguments change = GENERATE(Arguments{"heading.mount_offset_deg=3", "delay.source=fixed"},
                                      Arguments{"fusion.engine=documented", "documented.trust.sigma_m=0.02"});
    const auto key_of = [](const std::string& text) { return text.substr(0, text.find('=')); };
    const auto value_of = [](const std::string& text) { return text.substr(text.find('=') + 1); };
    settings::Settings other;
    for (const std::string& text : change) {
      settings::set(other, key_of(text), settings::parse_value(key_of(text), value_of(text)));
    }
    estimation::AnyEstimator estimator{settings::Settings{}};
    estimation::AnyEstimator unchanged{settings::Settings{}};
    std::vector<FusedPose> expected;
    std::size_t differing = 0;
    for (const Event& event : recording::read_sensor_log(folder / "log").events) {
      if (sequence_of(event) == from) estimator.configure(other);
      const auto output = estimation::process(estimator, event);
      const auto output_before = estimation::process(unchanged, event);
      const auto* pose = std::get_if<FusedPose>(&output);
      const auto* before = std::get_if<FusedPose>(&output_before);
      if (pose == nullptr) continue;
      expected.push_back(*pose);
      if (bits_of(*pose) != bits_of(*before)) ++differing;
    }
    REQUIRE(expected.size() == 2000);
    REQUIRE(differing > 1000);
    WHEN("the programs make the same change, requested before the bridge starts") {
      Consumer<sonopose_FusedPose> poses(bus, topics::pose);
      Consumer<sonopose_EffectiveSettings> settings(bus, topics::settings, dds::topics::Delivery::live);
      const auto fusion = bus.fusion({"--lossless"});
      REQUIRE(poses.wait_for_writers());
      const Result set = bus.settings({"set", change[0], change[1], "--from-event", std::to_string(from),
                                       "--beacon", GENERATE("7", "all")});
      CAPTURE(set.error);
      REQUIRE(set.code == 0);
      CHECK_THAT(set.output, Contains("event 1000"));
      REQUIRE(bus.bridge({"--source", "log", "--input", (folder / "log").string(), "--rate", "0"})
                  ->wait_for_exit() == 0);
      THEN("every pose is equal, and the new settings are published from that event on") {
        REQUIRE(poses.wait_for_count(expected.size()));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < expected.size(); ++i) {
          if (bits_of(poses.samples[i]) != bits_of(expected[i])) ++wrong;
        }
        CHECK(wrong == 0);
        REQUIRE(settings.wait_for([&](const EffectiveSettings& sample) {
          return sample.address == 7 &&
                 std::any_of(sample.values.begin(), sample.values.end(), [&](const auto& entry) {
                   return entry.key == key_of(change[1]) && entry.value == value_of(change[1]);
                 });
        }));
        CHECK(settings.samples.back().from_sequence == from);
      }
    }
  }
}

}  // namespace sonopose::settings_at_event_test
