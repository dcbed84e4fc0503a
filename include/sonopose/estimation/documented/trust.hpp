#pragma once
/// \file
/// Items 13–22: how far a fix is believed. A weight from its innovation, a trust in the track that is lost at
/// an outlier and rebuilt over consistent fixes, and forced convergence for an engine that has run away.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/declaration.hpp>

namespace sonopose::estimation::documented {

struct TrustSettings {
  double sigma_m{};
  double min_weight{};
  bool enabled{};
  double reference_innovation_m{};
  int n_base{};
  int n_min{};
  int n_max{};
  int stuck_n{};
  double stuck_jump_scale{};
  double stuck_weight_floor{};
  double outlier_sigmas{};

  static constexpr std::string_view group = "trust";
  static constexpr auto declarations() {
    using G = TrustSettings;
    using settings::count;
    using settings::own_setting;
    using settings::real;
    return settings::rows(
        real(13, "sigma_m", &G::sigma_m, 0.15, {0.001, 10.0}, "m",
             "A fix this far from the velocity-predicted position has weight 0.5; farther, less."),
        real(14, "min_weight", &G::min_weight, 0.003, {0.0, 1.0}, "",
             "Floor of the weight of any fix, however large its innovation."),
        settings::flag(15, "enabled", &G::enabled, true,
                       "After an outlier, compare fixes with the IMU's prediction and rebuild trust over "
                       "consistent ones."),
        real(16, "reference_innovation_m", &G::reference_innovation_m, 1.0, {0.01, 100.0}, "m",
             "A jump of this size takes n_base fixes to be trusted again; others in proportion."),
        count(17, "n_base", &G::n_base, 2, {1, 1000}, "fixes",
              "Fixes that rebuild full trust after a jump of the reference size."),
        count(18, "n_min", &G::n_min, 2, {1, 1000}, "fixes", "Least number of fixes that rebuild trust."),
        count(19, "n_max", &G::n_max, 40, {1, 1000}, "fixes",
              "Most fixes that rebuild trust; after so many the track is accepted whatever it is."),
        count(20, "stuck_n", &G::stuck_n, 32, {1, 1000}, "fixes",
              "Consecutive outliers at zero trust that force convergence."),
        real(21, "stuck_jump_scale", &G::stuck_jump_scale, 0.6, {0.0, 1.0}, "",
             "Least share of the remaining error that is removed at each fix while convergence is forced."),
        real(22, "stuck_weight_floor", &G::stuck_weight_floor, 0.5, {0.0, 1.0}, "",
             "Floor of the drift's weight while convergence is forced."),
        real(own_setting, "outlier_sigmas", &G::outlier_sigmas, 1.75, {0.5, 100.0}, "",
             "A fix whose innovation exceeds this many sigma_m is an outlier."));
  }
  constexpr TrustSettings() { settings::set_defaults(*this); }
};

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
