#include "doctor/rules/checks.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace sonopose::doctor::rules {
namespace {

/// Fewest outliers for a finding: good fixes contain hardly any.
constexpr std::size_t min_outliers = 4;
constexpr double min_share = 0.02;
/// Smallest share of scattered outliers. Some spikes occur in any hall, and the fusion rejects them.
constexpr double min_scattered_share = 0.08;
/// Largest distance between fixes of one track, as a share of their distance from the motion.
constexpr double track_width = 0.35;
constexpr double track_noise_m = 0.15;
constexpr double track_share = 0.6;

/// Median of each coordinate.
Vector3d median_of(std::vector<Vector3d> all) {
  Vector3d median;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end(),
                     [axis](const Vector3d& a, const Vector3d& b) { return a(axis) < b(axis); });
    median(axis) = (*middle)(axis);
  }
  return median;
}

/// Centre of these fixes, if most are on one track.
std::optional<Vector3d> track_of(const std::vector<Vector3d>& outliers_m) {
  const Vector3d track_m = median_of(outliers_m);
  const double width_m = track_width * track_m.norm() + track_noise_m;
  const auto near = std::count_if(outliers_m.begin(), outliers_m.end(),
                                  [&](const Vector3d& each) { return (each - track_m).norm() < width_m; });
  const bool is_track = track_m.norm() > track_noise_m &&
                        static_cast<double>(near) > track_share * static_cast<double>(outliers_m.size());
  return is_track ? std::optional(track_m) : std::nullopt;
}

bool are_many(std::size_t outliers, std::uint64_t fixes, double share = min_share) {
  return outliers >= min_outliers && static_cast<double>(outliers) > share * static_cast<double>(fixes);
}

/// Reports fixes on a second track, or scattered ones. Returns true if there is a finding.
bool check_outliers(const BeaconObservation& beacon, Findings& findings) {
  std::vector<Vector3d> outliers_m = beacon.fix_outcomes.outliers_m;
  std::uint64_t fixes = beacon.fix_outcomes.reports;
  std::string count =
      fmt::format("its fusion takes {} of its {} fixes for outliers", outliers_m.size(), fixes);
  if (!are_many(outliers_m.size(), fixes)) {
    // A fusion that follows each track rejects few fixes of either.
    outliers_m.clear();
    fixes = 0;
    for (const motion::fit::Piece& piece : beacon.pieces) {
      outliers_m.insert(outliers_m.end(), piece.outliers_m.begin(), piece.outliers_m.end());
      fixes += piece.fixes;
    }
    count = fmt::format("the IMU contradicts {} of its {} fixes", outliers_m.size(), fixes);
    constexpr double outlier_share = 0.15;  // fewer are noise of fix and IMU
    if (static_cast<double>(outliers_m.size()) < outlier_share * static_cast<double>(fixes)) return false;
  }
  if (!are_many(outliers_m.size(), fixes)) return false;
  if (const auto track_m = track_of(outliers_m)) {
    findings.push_back(
        {Severity::warning, name_of(beacon),
         fmt::format("{}: they are on a second track, {:.2f} m off ({:.2f}, {:.2f}, {:.2f} m)", count,
                     track_m->norm(), track_m->x(), track_m->y(), track_m->z()),
         "look for a reflection, a second beacon with this address, or a stationary beacon in the wrong "
         "place on the map"});
  } else if (are_many(outliers_m.size(), fixes, min_scattered_share)) {
    findings.push_back({Severity::warning, name_of(beacon), count + ", which are scattered",
                        "check for reflections and a poor line of sight to the stationary beacons; set "
                        "admission.min_quality_percent"});
  } else {
    return false;
  }
  return true;
}

struct FixAdvice {
  Severity severity;
  const char* remedy;
};

/// Advice for a fault; empty for one that the status of the poses names.
std::optional<FixAdvice> advice_for(motion::FixFaultKind kind) {
  switch (kind) {
    case motion::FixFaultKind::unit:
      return FixAdvice{Severity::error, "publish the positions in m: they seem to be in mm or cm"};
    case motion::FixFaultKind::default_position:
      return FixAdvice{Severity::warning, "let the driver leave out fixes that were not measured"};
    case motion::FixFaultKind::repeated:
      return FixAdvice{Severity::warning, "let the driver send each position once"};
    case motion::FixFaultKind::headings_in_radians:
      return FixAdvice{Severity::error, "correct the unit in their driver: they seem to be in rad"};
    case motion::FixFaultKind::headings_constant:
      return FixAdvice{Severity::error,
                       "use a source that measures them, or none: many drivers fill an unknown orientation"};
    case motion::FixFaultKind::frozen:
      break;
  }
  return std::nullopt;
}

}  // namespace

bool check_fixes(const BeaconObservation& beacon, Findings& findings) {
  bool are_usable = true;
  for (const motion::FixFault& fault : beacon.fix_faults) {
    const auto advice = advice_for(fault.kind);
    if (!advice) continue;
    findings.push_back({advice->severity, name_of(beacon), fault.text, advice->remedy});
    are_usable = are_usable && fault.kind == motion::FixFaultKind::default_position;
  }
  return are_usable;
}

void check_tracks(const BeaconObservation& beacon, bool is_frozen, Findings& findings) {
  if (!is_frozen && check_outliers(beacon, findings)) return;
  // In a long run, the fixes outnumber those rejected before the fusion follows another track.
  const FixOutcomes& fixes = beacon.fix_outcomes;
  if (fixes.relocations == 0) return;
  findings.push_back(
      {Severity::warning, name_of(beacon),
       fmt::format("its position jumped {}, by up to {:.2f} m, to fixes that it had rejected",
                   fixes.relocations == 1 ? "once" : text::count_text(fixes.relocations, "time"),
                   fixes.longest_relocation_m),
       "check whether the map was changed or the beacon was carried away; otherwise look for a reflection"});
}

}  // namespace sonopose::doctor::rules
