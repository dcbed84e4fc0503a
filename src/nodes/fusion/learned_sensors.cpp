#include "fusion/learned_sensors.hpp"

#include "clocks/clocks.hpp"
#include "files/replacement.hpp"
#include "logging/log.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cstddef>
#include <system_error>
#include <utility>

namespace sonopose::fusion {
namespace {

constexpr TimeNs save_period_ns = 60'000'000'000;
constexpr TimeNs relearn_ns = 600'000'000'000;  ///< wait after a change of the mounting

std::optional<estimation::aiding::KnownSensors> known_now(const Estimate& estimate) {
  return estimation::aiding::known_after(estimate, seconds_between(estimate.time_ns, clocks::host_now()));
}

/// "none", or "calibration.axes=+y-x+z, heading.mount_offset_deg=90".
std::string text_of(const std::vector<std::string>& mounting) {
  return mounting.empty() ? "none" : fmt::format("{}", fmt::join(mounting, ", "));
}

/// Returns the error, if any.
std::string write(const std::filesystem::path& file, const config::LearnedSensors& learned) {
  try {
    files::write_whole(file, config::learned_toml(learned));
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace

LearnedSensorsFile::LearnedSensorsFile(const std::filesystem::path& file, const config::FusionConfig& config)
    : file_(file), due_(clocks::steady_now() + save_period_ns) {
  try {
    learned_ = config::read_learned(file);
  } catch (const config::ConfigError& error) {
    is_readable_ = false;
    logging::warning(fmt::format("{}; the file is ignored and never overwritten: delete it to start afresh",
                                 error.what()));
    return;
  }
  std::size_t known = 0;
  for (const auto& [address, beacon] : learned_) {
    const auto mounting = config::mounting_of(config.for_beacon(address));
    if (mounting != beacon.mounting) {
      logging::warning(fmt::format(
          "{}: beacon {}: not used, because it was learned with other settings of calibration and "
          "mount: {}; now: {}",
          file.string(), address, text_of(beacon.mounting), text_of(mounting)));
    } else if (known_now(beacon.estimate)) {
      ++known;
    } else {
      logging::warning(
          fmt::format("{}: beacon {}: not used, because it is incomplete, older than 30 days, "
                      "or has values that no real sensor has",
                      file.string(), address));
    }
  }
  logging::info(fmt::format("{}: sensors of {} known", file.string(), text::count_text(known, "beacon")));
}

std::optional<estimation::aiding::KnownSensors> LearnedSensorsFile::known(
    BeaconAddress address, const settings::Settings& settings) {
  auto mounting = config::mounting_of(settings);
  const auto found = learned_.find(address);
  const bool is_known = found != learned_.end() && found->second.mounting == mounting;
  mountings_.insert_or_assign(address, Mounting{std::move(mounting)});
  if (!is_known) return std::nullopt;
  return known_now(found->second.estimate);
}

void LearnedSensorsFile::update(threads::Guarded<BeaconEstimators>& estimators, SteadyTime now) {
  using std::chrono::seconds;
  if (now < due_) return;
  if (writing_.valid() && writing_.wait_for(seconds(0)) != std::future_status::ready) return;  // a slow disk
  report_last();
  due_ = now + save_period_ns;
  save(estimators);
}

void LearnedSensorsFile::finish(threads::Guarded<BeaconEstimators>& estimators) {
  report_last();
  save(estimators);
  report_last();
}

/// Waits for the file, and reports an error.
void LearnedSensorsFile::report_last() {
  if (writing_.valid()) report(writing_.get());
}

/// Logs an error that is not that of the last time.
void LearnedSensorsFile::report(const std::string& error) {
  if (!error.empty() && error != reported_) {
    logging::warning(fmt::format("cannot save the learned sensor errors: {}", error));
  }
  reported_ = error;
}

void LearnedSensorsFile::save(threads::Guarded<BeaconEstimators>& estimators) {
  if (!is_readable_) return;
  bool has_news = false;
  config::LearnedSensors learned;
  estimators.with([&](auto& all) {
    all.for_each([&](BeaconAddress address, BeaconEstimator& estimator) {
      auto mounting = config::mounting_of(estimator.timeline().settings());
      Mounting& before = mountings_.try_emplace(address, Mounting{mounting}).first->second;
      if (before.settings != mounting) before = {mounting, clocks::steady_now()};
      if (before.changed && clocks::steady_now() - *before.changed < relearn_ns) return;
      auto estimate = estimator.learned();
      if (!estimate) return;
      estimate->time_ns = clocks::host_now();
      learned_.insert_or_assign(address, config::LearnedBeacon{*std::move(estimate), std::move(mounting)});
      has_news = true;
    });
    learned = learned_;
  });
  if (!has_news) return;
  try {
    writing_ = std::async(std::launch::async, write, file_, std::move(learned));
  } catch (const std::system_error& error) {  // no thread
    report(error.what());
  }
}

}  // namespace sonopose::fusion
