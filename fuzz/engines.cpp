// Runs collator and engines of the fusion on any events in any order, with any settings.

#include "fused_events.hpp"
#include "fusion/beacon_estimator.hpp"
#include "support.hpp"

#include <optional>
#include <tuple>

using namespace sonopose;
using namespace sonopose::fuzz;

namespace {

constexpr BeaconAddress address = 7;
constexpr int max_events = 120;

/// Returns empty if the fusion would not start with the settings.
std::optional<config::FusionConfig> any_config(FuzzedDataProvider& data) {
  config::FusionConfig config;
  config.assign(data.ConsumeBool() ? "fusion.engine=kalman" : "fusion.engine=documented");
  const int assignments = data.ConsumeIntegralInRange(0, 20);
  for (int i = 0; i < assignments; ++i) {
    const std::string key = setting_key(data);
    accepts<config::ConfigError>([&] { config.assign(key + "=" + setting_value(data, key)); });
  }
  if (!accepts<config::ConfigError>([&] { config.check(); })) return std::nullopt;
  return config;
}

void check_counters(const FusionStatus& status, std::uint64_t events) {
  promise(status.imu_samples + status.samples_invalid + status.fixes_used + status.fixes_rejected +
                  status.events_duplicated <=
              2 * events,
          "each event is counted once, or again when a numbering restarts");
  promise(status.events_lost <= events * collation::max_lost, "an event reveals a bounded gap");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  const auto config = any_config(data);
  if (!config) return 0;
  fusion::BeaconEstimator estimator(address, fusion::SettingsTimeline(config->beacon(address)),
                                    data.ConsumeBool());
  constexpr TimeNs start_ns = 1'700'000'000'000'000'000;
  EventStream stream(data, start_ns, address);
  SteadyTime now{1'000'000'000};
  std::uint64_t events = 0;
  while (stream.has_more() && events < max_events) {
    ++events;
    now += 5'000'000;
    estimator.collate(stream.next(), 0, now, now);
    while (const auto outcome = estimator.process_next()) check_result(outcome->result);
    if (events % 64 == 0) estimator.reset(0);
  }
  check_counters(estimator.status(), events);
  std::ignore = estimator.fix_refusals(now);
  std::ignore = estimator.estimate();
  std::ignore = estimator.gap();
  return 0;
}
