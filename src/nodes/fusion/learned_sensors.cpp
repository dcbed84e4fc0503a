#include "fusion/learned_sensors.hpp"

#include "clocks/clocks.hpp"
#include "files/replacement.hpp"
#include "logging/log.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace sonopose::fusion {
namespace {

constexpr TimeNs save_period_ns = 60'000'000'000;

/// Replaces the beacons of the file by these. Returns the error, if any.
std::string write(const std::filesystem::path& file, const config::LearnedSensors& learned) {
  try {
    config::LearnedSensors all;
    try {
      all = config::read_learned(file);
    } catch (const config::ConfigError&) {
      // The start has warned of it; what is learned now replaces it.
    }
    for (const auto& [address, estimate] : learned) all.insert_or_assign(address, estimate);
    files::write_whole(file, config::learned_toml(all));
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace

KnownOfBeacons read_known(const std::filesystem::path& file, TimeNs host_now_ns) {
  KnownOfBeacons known;
  try {
    const config::LearnedSensors learned = config::read_learned(file);
    for (const auto& [address, estimate] : learned) {
      const double age_s = seconds_between(estimate.time_ns, host_now_ns);
      if (const auto still = estimation::aiding::known_after(estimate, age_s)) known.emplace(address, *still);
    }
    logging::info(fmt::format("{}: sensors of {} known, of {} in the file", file.string(),
                              text::count_text(known.size(), "beacon"), learned.size()));
  } catch (const config::ConfigError& error) {
    logging::warning(fmt::format("{}; the estimates begin without it", error.what()));
  }
  return known;
}

LearnedSensorsFile::LearnedSensorsFile(const std::filesystem::path& file)
    : file_(file), due_(clocks::steady_now() + save_period_ns) {}

void LearnedSensorsFile::update(threads::Guarded<BeaconEstimators>& estimators, SteadyTime now) {
  using std::chrono::seconds;
  if (now < due_) return;
  if (writing_.valid() && writing_.wait_for(seconds(0)) != std::future_status::ready) return;  // a slow disk
  report_error();
  due_ = now + save_period_ns;
  save(estimators);
}

void LearnedSensorsFile::finish(threads::Guarded<BeaconEstimators>& estimators) {
  report_error();
  save(estimators);
  report_error();
}

/// Waits for the file. Logs an error that is not that of the last time.
void LearnedSensorsFile::report_error() {
  if (!writing_.valid()) return;
  const std::string error = writing_.get();
  if (!error.empty() && error != reported_) {
    logging::warning(fmt::format("what was learned of the sensors is not saved: {}", error));
  }
  reported_ = error;
}

void LearnedSensorsFile::save(threads::Guarded<BeaconEstimators>& estimators) {
  config::LearnedSensors learned;
  estimators.with([&](auto& all) {
    all.for_each([&](BeaconAddress address, BeaconEstimator& estimator) {
      if (auto estimate = estimator.learned()) learned.emplace(address, *std::move(estimate));
    });
  });
  if (learned.empty()) return;
  for (auto& [address, estimate] : learned) estimate.time_ns = clocks::host_now();
  writing_ = std::async(std::launch::async, write, file_, std::move(learned));
}

}  // namespace sonopose::fusion
