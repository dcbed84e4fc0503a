// Reads a file of what a fusion has learned of the sensors. An accepted one is saved as it was read, and an
// engine begins with its values.

#include "config/learned_file.hpp"

#include "config/fusion_config.hpp"
#include "fused_events.hpp"
#include "support.hpp"
#include <sonopose/estimation/aiding/known_sensors.hpp>
#include <sonopose/estimation/any_estimator.hpp>

#include <array>
#include <cstdint>
#include <string>

using namespace sonopose;
using namespace sonopose::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ScratchFolder folder;
  const auto file = folder.write("learned.toml", text_of(data, size));
  config::LearnedSensors learned;
  if (!accepts<config::ConfigError>([&] { learned = config::read_learned(file); })) return 0;
  const std::string saved = config::learned_toml(learned);
  const auto again = config::read_learned(folder.write("saved.toml", saved));
  promise(config::learned_toml(again) == saved, "an accepted file is saved as it was read");
  for (const auto& [address, beacon] : learned) {
    constexpr double day_s = 86'400.0;
    for (const double age_s : {-1.0, 0.0, day_s, 31.0 * day_s}) {
      const auto known = estimation::aiding::known_after(beacon.estimate, age_s);
      if (!known) continue;
      promise(age_s <= 30.0 * day_s && estimation::aiding::is_plausible(*known), "what is used is plausible");
      estimation::AnyEstimator estimator(settings::Settings{});
      estimator.start_from(*known);
      const std::array<std::uint8_t, 64> runs{};
      FuzzedDataProvider random(runs.data(), runs.size());
      EventStream stream(random, 1'700'000'000'000'000'000, address);
      for (int i = 0; i < 20; ++i) check_result(estimation::process(estimator, stream.next()));
    }
  }
  return 0;
}
