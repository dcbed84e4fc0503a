#pragma once
/// \file
/// Items 13–22: how far a fix is believed. A weight from its innovation, a trust in the track that is lost at
/// an outlier and rebuilt over consistent fixes, and forced convergence for an engine that has run away.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

namespace sonopose::estimation::documented {

using settings::TrustSettings;

struct TrustState {
  double trust = 1.0;       ///< 0…1
  int rebuild_n = 0;        ///< consistent fixes that full trust takes
  int rebuilt = 0;          ///< of these, had so far
  int since_loss = 0;       ///< fixes since trust was lost
  int outliers_in_row = 0;  ///< at zero trust
  bool forced = false;      ///< convergence is being forced
  bool has_last = false;
  TimeNs last_measured_ns = 0;  ///< the track's latest fix
  Vector3d last_position_world_m = Vector3d::Zero();

  bool operator==(const TrustState&) const = default;
};

/// What the later stages apply; they ask nothing more about trust.
struct FixAssessment {
  Vector3d innovation_world_m = Vector3d::Zero();
  double innovation_m = 0;  ///< its norm
  double weight = 1;        ///< w_eff = max(item 14, w · trust)
  double jump_floor = 0;    ///< item 21 while convergence is forced
  double weight_floor = 0;  ///< item 22 while convergence is forced
  bool outlier = false;
  bool forced = false;
  bool trusted = true;         ///< trust in the track is full
  bool accepted_anew = false;  ///< with this fix the track has won over the IMU: items 19 and 20
  bool new_track = false;      ///< no velocity can be measured from the fixes before this one to it
};

namespace trust {

/// w = 1 / (1 + (r/σ)²): one half at r = σ (item 13).
[[nodiscard]] double weight_of(double innovation_m, double sigma_m);

/// Whether a pose so far from its fix is still converging: a fix there would have less than half its weight.
[[nodiscard]] bool is_far(const TrustSettings& settings, double distance_m);

/// Judges a fix by its innovation to the position that the previous fix and the IMU's velocity predict, or,
/// while trust is not full, to the fused position itself (item 15).
FixAssessment judge(const TrustSettings& settings, TrustState& state, const Kinematics& body,
                    const TimedFix& fix);

/// Begins anew at `fix`, fully trusted: at the start and after stale mode.
void restart(TrustState& state, const TimedFix& fix);

}  // namespace trust
}  // namespace sonopose::estimation::documented
