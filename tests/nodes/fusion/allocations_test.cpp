/// The live path does not allocate, before and after a change of settings.

#include "support/allocations.hpp"

#include "fusion/estimators_feeder.hpp"

#include <catch2/catch.hpp>

namespace allocations_test {

using namespace sonopose;
using namespace sonopose::fusion;
using namespace sonopose::fusion::test;

SCENARIO("a live event does not allocate, even while a change waits and when it applies") {
  const auto events = walk(7, 10.0);
  const auto engine = GENERATE(settings::EngineKind::documented, settings::EngineKind::kalman);
  threads::Guarded<BeaconEstimators> estimators(config_of(engine), false);
  std::size_t poses = 0;
  std::size_t changes = 0;
  const auto allocated_by = [&](std::size_t first, std::size_t last) {
    const std::size_t before = sonopose::test::allocations();
    for (std::size_t i = first; i < last; ++i) {
      const auto estimator = estimators.with([](auto& all) { return all.find_or_make(7); });
      const SteadyTime arrival{available_at_ns(events[i])};
      estimator->collate(events[i], 0, arrival, arrival);
      while (const auto outcome = estimator->process_next()) {
        if (std::holds_alternative<FusedPose>(outcome->result)) ++poses;
        if (outcome->settings_changed) ++changes;
      }
    }
    return sonopose::test::allocations() - before;
  };
  CHECK(allocated_by(0, 1) > 0);  // the engine allocates, so counting works
  CHECK(allocated_by(1, 300) == 0);
  SettingsRequests(estimators)
      .answer({.address = 7,
               .request_id = 1,
               .from_sequence = sequence_of(events[400]),
               .assignments = {{"documented.trust.sigma_m", "0.5"}}});
  CHECK(allocated_by(300, events.size()) == 0);
  CHECK(poses == 1000);
  CHECK(changes == 2);
}

SCENARIO("a live event does not allocate with any attitude filter") {
  const auto events = walk(7, 4.0);
  for (const std::string_view filter : choices_of(attitude::FilterKind{})) {
    config::FusionConfig config = documented_config();
    config.assign("documented.attitude.filter=" + std::string(filter));
    config.assign("documented.attitude.magnetometer=true");
    BeaconEstimators estimators(config, false);
    const auto push = [&](Event event) {
      if (auto* imu = std::get_if<ImuSample>(&event)) imu->magnetic_field_body_t = Vector3d(20e-6, 0, -40e-6);
      const std::size_t before = sonopose::test::allocations();
      const auto estimator = estimators.find_or_make(7);
      const SteadyTime arrival{available_at_ns(event)};
      estimator->collate(event, 0, arrival, arrival);
      while (estimator->process_next()) {
      }
      return sonopose::test::allocations() - before;
    };
    INFO(filter);
    CHECK(push(events[0]) > 0);
    std::size_t allocated = 0;
    for (std::size_t i = 1; i < events.size(); ++i) allocated += push(events[i]);
    CHECK(allocated == 0);
  }
}

}  // namespace allocations_test
