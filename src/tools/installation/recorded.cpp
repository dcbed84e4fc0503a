#include "installation/recorded.hpp"

#include "installation/sample_window.hpp"
#include "motion/fix_faults.hpp"
#include "motion/imu_faults.hpp"
#include <sonopose/calibration/model/axes_check.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <variant>

namespace sonopose::installation {
namespace {

/// False if the input check names a fault that makes every fit wrong. Readings that are held for a while have
/// been removed.
bool is_fit_possible(const motion::Window& window, const Evidence& evidence) {
  if (motion::force_unit_of(evidence.imu_summary) != motion::ForceUnit::mps2 ||
      motion::has_rates_in_degrees(evidence.imu_summary) || !motion::imu_faults_of(window).empty()) {
    return false;
  }
  const auto faults = motion::fix_faults_of(window, evidence.turn_gain);
  return std::ranges::all_of(faults, [](const motion::FixFault& fault) {
    return fault.kind == motion::FixFaultKind::default_position;
  });
}

}  // namespace

std::vector<Finding> findings_in(std::span<const Event> events, const settings::Settings& settings,
                                 Search search) {
  constexpr std::size_t brief_pieces = 3;
  SampleWindow samples(settings);
  calibration::AxesCheck axes(settings.calibration);
  Evidence evidence;
  evidence.settings = settings;
  std::size_t fixes = 0;
  std::size_t timed_fixes = 0;
  std::optional<double> min_fix_delay_s;
  for (const Event& event : events) {
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      samples.add(*imu);
      axes.on(*imu);
    }
    if (const auto* heading = std::get_if<PairHeading>(&event)) samples.add(*heading);
    if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      samples.add(*fix);
      ++fixes;
      if (fix->measured_delay_s) ++timed_fixes;
      const double delay_s = seconds_between(fix->emission_time_ns, fix->received_time_ns);
      min_fix_delay_s = std::min(min_fix_delay_s.value_or(delay_s), delay_s);
    }
  }
  evidence.are_fixes_timed = 2 * timed_fixes > fixes;
  evidence.min_fix_delay_s = min_fix_delay_s.value_or(0.0);
  evidence.are_headings_of_body = samples.are_headings_of_body();
  motion::Window window = std::move(samples).window();
  motion::sort_by_time(window);
  motion::remove_held_readings(window);
  evidence.imu_summary = motion::summary_of(window.imu);
  evidence.turn_gain = motion::turn_gain_of(window);
  const bool is_possible = is_fit_possible(window, evidence);
  motion::remove_default_position(window.fixes);
  if (auto problem = axes.problem()) {
    // A wrong sign of z alone also turns the force upside down.
    if (is_possible) evidence.pieces = motion::fit::pieces_of(std::move(window));
    auto wrong_sign = wrong_sign_of_z(evidence);
    if (!wrong_sign.empty()) return wrong_sign;
    return {{.is_error = false, .text = std::move(problem->text), .remedy = std::move(problem->remedy)}};
  }
  if (!is_possible) return {};
  if (search == Search::brief) {
    evidence.pieces = motion::fit::pieces_of(window, {.max_pieces = brief_pieces, .with_changes = false});
    const bool is_any_judged = std::ranges::any_of(evidence.pieces, motion::fit::is_judged);
    if (is_any_judged && std::ranges::all_of(evidence.pieces, is_explained)) return {};
  }
  evidence.pieces = motion::fit::pieces_of(std::move(window));
  return findings_of(evidence);
}

}  // namespace sonopose::installation
