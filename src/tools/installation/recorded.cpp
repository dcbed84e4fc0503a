#include "installation/recorded.hpp"

#include "installation/sample_window.hpp"
#include "motion/fix_faults.hpp"
#include "motion/imu_faults.hpp"
#include <sonopose/calibration/model/axes_check.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <variant>

namespace sonopose::installation {
namespace {

/// False if the input check names a fault that makes every fit wrong.
bool are_usable(const motion::Window& window, const Evidence& evidence) {
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

std::vector<Finding> findings_in(const std::vector<Event>& events, const settings::Settings& settings,
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
  motion::Window window = std::move(samples).window();
  motion::sort_by_time(window);
  evidence.imu_summary = motion::summary_of(window.imu);
  evidence.turn_gain = motion::turn_gain_of(window);
  if (!are_usable(window, evidence)) return {};
  if (auto problem = axes.problem()) {
    return {{.is_error = false, .text = std::move(problem->text), .remedy = std::move(problem->remedy)}};
  }
  motion::remove_default_position(window.fixes);
  if (search == Search::brief) {
    evidence.pieces = motion::fit::pieces_of(window, {.max_pieces = brief_pieces, .with_changes = false});
    if (std::ranges::all_of(evidence.pieces, is_explained)) return {};
  }
  evidence.pieces = motion::fit::pieces_of(std::move(window));
  return findings_of(evidence);
}

}  // namespace sonopose::installation
