#pragma once
/// \file
/// Items 13–22: the weight of a fix. It follows from the fix's innovation and from the trust in the track. An
/// outlier removes trust; consistent fixes rebuild it. A diverged engine is forced to converge. Outliers that
/// agree with each other along the IMU's path are rivals of the pose. They show its velocity, and whether the
/// pose is moving away.

#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/estimation/documented/kinematics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <limits>
#include <optional>

namespace sonopose::estimation::documented {

using settings::TrustSettings;

struct TrustState {
  double trust = 1.0;       ///< 0…1
  int rebuild_n = 0;        ///< number of consistent fixes that restore full trust
  int rebuilt = 0;          ///< consistent fixes so far
  int since_loss = 0;       ///< fixes since trust was lost
  int outliers_in_row = 0;  ///< consecutive outliers at zero trust
  bool forced = false;      ///< true while convergence is forced
  bool has_last = false;
  TimeNs last_measured_ns = 0;  ///< measurement time of the track's latest fix
  Vector3d last_position_world_m = Vector3d::Zero();
  int rivals = 0;                ///< outliers that agree with each other along the IMU's path
  int strays = 0;                ///< outliers after the latest rival that do not agree with the rivals
  TimeNs rival_measured_ns = 0;  ///< measurement time of the latest rival
  Vector3d rival_position_world_m = Vector3d::Zero();
  Vector3d rival_excess_world_mps = Vector3d::Zero();  ///< velocity of the rivals minus the IMU's
  Vector3d rival_offset_world_m = Vector3d::Zero();    ///< offset of the first rival from the pose

  bool operator==(const TrustState&) const = default;
};

/// Assessment of one fix, for the later stages.
struct FixAssessment {
  Vector3d innovation_world_m = Vector3d::Zero();
  double innovation_m = 0;  ///< norm of the innovation
  double test_ratio = 0;    ///< (innovation_m / (outlier_sigmas · sigma_m))²: above 1 is an outlier
  double weight = 1;        ///< w_eff = max(item 14, w · trust)
  double jump_floor = 0;    ///< item 21 while convergence is forced
  double weight_floor = 0;  ///< item 22 while convergence is forced
  bool outlier = false;
  bool forced = false;
  double sigma_m = std::numeric_limits<double>::infinity();  ///< item 13 as it applies to this fix
  int rivals = 0;               ///< number of rivals up to this fix; 0: it is not a rival
  double rival_residual_m = 0;  ///< distance of this rival to its prediction from the others
  Vector3d rival_step_world_m =
      Vector3d::Zero();  ///< step from the previous rival, if they agree along the path
  bool trusted = true;   ///< true if trust in the track is full
  bool track_accepted =
      false;               ///< true if the track is accepted against the IMU with this fix (items 19 and 20)
  bool new_track = false;  ///< true if no velocity can be measured from the previous fixes to this one
};

namespace trust {

/// Weight w = 1 / (1 + (r/σ)²): one half at r = σ (item 13).
[[nodiscard]] double weight_of(double innovation_m, double sigma_m);

/// Share of each axis of a fix that counts, by its noise: 1 up to 35 % of item 13, then falling as 1/noise.
[[nodiscard]] Vector3d share_of(const TrustSettings& settings, const Vector3d& noise_world_m);

/// True if a pose at this distance from its fix is still converging: the fix's weight would be below one
/// half.
[[nodiscard]] bool is_far(const TrustSettings& settings, double distance_m);

/// Assesses a fix by its innovation. This is its distance to the position predicted from the previous fix and
/// the IMU's velocity or, while trust is not full, to the fused position (item 15). `velocities` is the
/// number of velocity corrections of this run if the velocity still averages them. The fewer there are, the
/// less certain the prediction. `yaw_error_mps` is the velocity that an uncertain yaw may have misdirected.
FixAssessment assess(const TrustSettings& settings, TrustState& state, const Kinematics& body,
                     const TimedFix& fix, std::optional<int> velocities = std::nullopt,
                     double yaw_error_mps = 0.0);

/// Restarts at `fix` with full trust, at the start and after stale mode.
void restart(TrustState& state, const TimedFix& fix);

}  // namespace trust
}  // namespace sonopose::estimation::documented
