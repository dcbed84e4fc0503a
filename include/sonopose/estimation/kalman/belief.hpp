#pragma once
/// \file
/// The state of the engine at one moment, computed from the events in the order of their measurement. It
/// depends on nothing else, so that events that arrive in another order give the same belief.

#include <sonopose/estimation/kalman/default_position.hpp>
#include <sonopose/estimation/kalman/explanations.hpp>
#include <sonopose/estimation/kalman/filter.hpp>
#include <sonopose/estimation/kalman/fix_noise.hpp>
#include <sonopose/estimation/kalman/imu_steps.hpp>
#include <sonopose/estimation/kalman/rest.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/settings/settings.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::estimation::kalman {

inline constexpr int model_count = 5;  ///< models of process noise
inline constexpr int closed_count =
    3;                               ///< those that trust the IMU; the others live only while they are needed
inline constexpr int open_gyro = 3;  ///< the one that hardly trusts the gyroscope
inline constexpr int open_accel = 4;  ///< the one that hardly trusts the accelerometer
constexpr bool is_open(int model) {
  return model == open_gyro || model == open_accel;
}
inline constexpr int start_count = 8;  ///< directions from which an unknown yaw is searched
/// While it is searched, the last candidate follows the fixes alone.
inline constexpr int most_candidates = start_count + 1;
inline constexpr int proven_fixes = 8;  ///< used fixes after which the first one is believed
inline constexpr double longest_heading_interval_s = 10.0;  ///< a longer one counts as this

// What is known before the first measurement: standard deviations per axis.
inline constexpr double start_gyro_bias_std_radps = 0.02;
inline constexpr double start_accel_bias_std_mps2 = 0.1;
inline constexpr double start_lever_arm_std_m = 0.05;

enum class Phase : std::uint8_t {
  waiting,        ///< for the first fix
  searching_yaw,  ///< one filter per start
  tracking        ///< one filter per noise model
};

constexpr std::array<std::string_view, 3> choices_of(Phase /*phase*/) {
  return {"waiting", "searching_yaw", "tracking"};
}

/// A filter and how well it explained the recent fixes.
struct Candidate {
  Filter filter;
  double score = 0;          ///< log-likelihood, with forgetting
  int rejected_in_row = 0;   ///< fixes that it could not explain
  int explained_in_row = 0;  ///< fixes since the last fix or heading that it could not explain

  bool operator==(const Candidate&) const = default;
};

/// A second track, through the fixes that the best filter rejects.
struct Rival {
  bool alive = false;
  TimeNs began_ns = 0;
  TimeNs last_fix_ns = 0;
  int fixes = 0;
  int misses_in_row = 0;
  int fixes_of_best = 0;    ///< that the best filter used in the meantime
  bool has_turned = false;  ///< its map has turned, by the headings that the best filter rejects
  int headings = 0;         ///< that agreed with a turned one
  Vector3d rejected_world_m = Vector3d::Zero();  ///< the latest fix that the best filter rejected
  TimeNs rejected_ns = 0;                        ///< its time
  Filter filter;

  bool operator==(const Rival&) const = default;
};

/// The track that was given up for the rival. While there is none, it is an anchor: a copy of the best filter
/// of some seconds ago, which the fixes since then could not lead astray. Only fixes that the best filter
/// rejects correct it.
struct Former {
  bool alive = false;
  bool is_anchor = false;
  TimeNs left_ns = 0;      ///< or when the anchor was copied
  TimeNs left_for_ns = 0;  ///< beginning of the track that replaced it
  int model = 0;           ///< of its process noise: that of later fixes may be due to a wrong track
  int fixes_in_row = 0;
  Filter filter;

  bool operator==(const Former&) const = default;
};

/// Remembers how long wrong tracks last here. The longest duration decays exponentially; the wait of others
/// is proportional to it and bounded, so a long track keeps it at its maximum for longer.
struct WrongTracks {
  double longest_s = 0;  ///< as it was at `seen_ns`
  TimeNs seen_ns = 0;

  void add(double duration_s, TimeNs now_ns);
  [[nodiscard]] double wait_s(TimeNs now_ns) const;
  bool operator==(const WrongTracks&) const = default;

private:
  [[nodiscard]] double faded_s(TimeNs now_ns) const;
};

/// Detects a track that repeats its coordinates.
struct Repetition {
  bool has_fix = false;
  bool frozen = false;
  int repeats = 0;
  Vector3d coordinates_world_m = Vector3d::Zero();
  TimeNs began_ns = 0;
  Vector3d moved_world_m = Vector3d::Zero();       ///< inertial path since then, without corrections
  Vector3d velocity_world_mps = Vector3d::Zero();  ///< along it

  bool operator==(const Repetition&) const = default;
};

/// Adds the variance of what an irregular step may miss.
void add_missed_motion(Filter& filter, const ImuStep& step);

/// Of a calibrated sample.
[[nodiscard]] ImuMeasurement as_measurement(const ImuSample& calibrated);

/// A fix at the time of its measurement.
struct FixMeasurement {
  TimeNs time_ns = 0;
  TimeNs stamp_ns = 0;  ///< of the source: the same in every copy of a fix, whenever it arrives
  Vector3d position_world_m = Vector3d::Zero();
  double quality_percent = -1;  ///< negative: unknown
  bool has_covariance = false;
  Matrix3d covariance_world_m2 = Matrix3d::Zero();  ///< if the source knows it

  bool operator==(const FixMeasurement&) const = default;
};

struct HeadingMeasurement {
  TimeNs time_ns = 0;
  TimeNs stamp_ns = 0;
  double heading_world_rad = 0;

  bool operator==(const HeadingMeasurement&) const = default;
};

/// What became of a fix.
struct FixOutcome {
  Innovation innovation;
  bool has_innovation = false;
  Matrix3d covariance_world_m2 = Matrix3d::Zero();  ///< of the fix as it was used or rejected; zero: unknown
  double test_ratio = 0;                            ///< squared norm over the rejection threshold
  double weight = 0;                                ///< 1: full; 0: rejected
  // What the fix changed at its time:
  Vector3d jump_world_m = Vector3d::Zero();
  Vector3d velocity_change_world_mps = Vector3d::Zero();
  double yaw_change_rad = 0;
  std::uint32_t flags = 0;
  bool starts = false;           ///< the estimate started at it
  std::uint32_t hypothesis = 0;  ///< 1: it agreed with the rival track
};

/// What became of a heading.
struct HeadingOutcome {
  bool used = false;
  double variance_rad2 = 0;        ///< of the heading as it was used or rejected; 0: unknown
  double added_variance_rad2 = 0;  ///< of yaw, before the heading was used: it was believed against the yaw
};

/// What an IMU sample showed besides the motion.
struct ImuOutcome {
  bool still = false;               ///< it ends half a second of rest: rest.still_gyro_mean is the gyro bias
  double still_rate_variance = 0;   ///< of that bias, (rad/s)²
  double no_velocity_variance = 0;  ///< of a velocity of zero, (m/s)²; 0: no such measurement
};

/// Share of the other directions of an unknown yaw in the covariance of the best filter.
struct Spread {
  double yaw_rad2 = 0;
  Matrix3d position_m2 = Matrix3d::Zero();
  Matrix3d velocity_m2ps2 = Matrix3d::Zero();
};

struct Belief {
  Phase phase = Phase::waiting;
  TimeNs time_ns = 0;                           ///< of the latest IMU sample; 0 before the first
  Vector3d rate_body_radps = Vector3d::Zero();  ///< of that sample
  Vector3d force_body_mps2 = Vector3d::Zero();
  Vector3d mean_force_body_mps2 = Vector3d::Zero();  ///< low-passed until the first fix
  TimeNs state_ns = 0;  ///< of the filters after the open steps: that sample, or a later measurement in a
                        ///< silence of the IMU
  bool in_imu_gap = false;
  bool restart_pending = false;  ///< a gap left the yaw unknown: the next fix starts the estimate again
  ShockDetector shocks;
  RestState rest;
  MeasurementNoise noise;
  Repetition repetition;
  int best = 0;  ///< candidate
  int candidate_count = 0;
  std::array<Candidate, most_candidates> candidates;
  Rival rival;
  Former former;
  JoinedSteps open_steps;  ///< not yet applied to the filters; none in a checkpoint
  WrongTracks wrong_tracks;
  DefaultPosition default_position;
  Correlation correlation;
  Explanations explanations;
  TimeNs suspicious_until_ns = 0;  ///< up to when fixes or headings that fit badly keep the open models alive
  TimeNs imu_doubted_until_ns =
      0;                      ///< up to when the last fix showed that the IMU is wrong, and a little longer
  TimeNs imu_doubted_ns = 0;  ///< when an open model last became the best; 0: never
  int imu_doubts = 0;         ///< how often of late
  Vector3d trusted_gyro_bias_body_radps = Vector3d::Zero();  ///< before the doubt
  Vector3d trusted_accel_bias_body_mps2 = Vector3d::Zero();
  TimeNs last_fix_ns = 0;     ///< measurement of the last fix that was used; 0: none
  int fixes_since_start = 0;  ///< that were used; up to proven_fixes
  int fixes_rejected_in_row = 0;
  double usual_step_s = 0;               ///< between IMU samples; 0: not known
  TimeNs last_heading_ns = 0;            ///< of the last heading that was used
  double last_heading_rad = 0;           ///< turned to the latest IMU sample while it is current
  bool heading_is_current = false;       ///< it is recent, and no gap of the IMU followed: a start may use it
  TimeNs heading_rejected_since_ns = 0;  ///< first rejected heading of the present run of them; 0: none
  TimeNs heading_rejected_ns = 0;        ///< last rejected heading
  int headings_rejected_in_row = 0;
  double heading_rejected_by_rad = 0;  ///< innovation of the last rejected heading
  TimeNs heading_seen_ns = 0;          ///< of the last heading, used or not
  double heading_interval_s = 0;       ///< between most headings; up to longest_heading_interval_s
  double quality_percent = -1;         ///< of the last fix that was used; negative: unknown
  TimeNs converging_until_ns = 0;
  TimeNs slowed_ns = 0;  ///< last bound of dead reckoning
  double trust = 1;      ///< share of recent fixes that were used

  bool operator==(const Belief&) const = default;

  [[nodiscard]] const Filter& filter() const { return candidates[static_cast<std::size_t>(best)].filter; }

  /// The mean square of the distance of all starts from the best one, weighted by their likelihood; zero
  /// while tracking.
  [[nodiscard]] Spread spread() const;

  /// Directions that are left of an unknown yaw.
  [[nodiscard]] int start_count_now() const { return candidate_count - 1; }

  /// Copies only what is in use.
  void copy_from(const Belief& other);

  ImuOutcome on_imu(const settings::Settings& settings, const ImuMeasurement& imu);
  FixOutcome on_fix(const settings::Settings& settings, const FixMeasurement& fix);
  HeadingOutcome on_heading(const settings::Settings& settings, const HeadingMeasurement& heading);

  /// The mount offset was changed by this angle: if headings have held the yaw until now, it is as uncertain.
  void on_mount_offset_change(double by_rad);

  /// The nominal state of the best filter at the latest sample, after the open steps.
  [[nodiscard]] NominalState nominal() const;
  /// The same after one more step.
  [[nodiscard]] NominalState nominal_after(const ImuStep& step) const;

  /// Applies the open steps to all filters.
  void close_steps();

  /// Applies the open steps, and propagates the covariance of every filter to the time of the latest sample.
  void propagate();

  /// Whether no fix or heading has made that necessary for a while.
  [[nodiscard]] bool covariance_is_old() const;

private:
  template <class Visit>
  void for_each_filter(const Visit& visit);
  void predict(const ImuStep& step);
  [[nodiscard]] bool can_join(double duration_s) const;
  void start_at(const FixMeasurement& fix, const settings::Settings& settings);
  [[nodiscard]] Filter initial_filter(bool at_rest) const;
  [[nodiscard]] double yaw_of_last_heading_rad(TimeNs fix_ns, const settings::Settings& settings) const;
  void coast_to(TimeNs to_ns);
  void coast_if_silent(const settings::Settings& settings, TimeNs measured_ns);
  void end_imu_gap(TimeNs to_ns);
  void estimate_delay(const settings::DelaySettings& settings);
  [[nodiscard]] Matrix3d covariance_of(const FixMeasurement& fix) const;
  void recover_if_not_finite();
  [[nodiscard]] bool map_has_turned(TimeNs now_ns) const;
  bool reject_heading(TimeNs now_ns, double innovation_rad);
  void see_heading(const HeadingMeasurement& heading);
  void keep_heading(const settings::Settings& settings, const HeadingMeasurement& heading);
  HeadingOutcome score_starts(const settings::Settings& settings, const HeadingMeasurement& heading);
  HeadingOutcome judge_heading(const settings::Settings& settings, const HeadingMeasurement& heading);
  [[nodiscard]] double heading_run_ends_s() const;
  void turn_rival(const HeadingMeasurement& heading, double mount_rad, double innovation_rad);
  [[nodiscard]] double up_rate_radps() const;
  void turn_last_heading(const ImuMeasurement& imu);
  [[nodiscard]] bool stands_still(int least_fixes) const;
  void update_rest(const ImuMeasurement& imu, ImuOutcome& outcome);
  void bound_dead_reckoning(ImuOutcome& outcome);
  using Innovations = std::array<Innovation, most_candidates>;  ///< of each candidate
  [[nodiscard]] Innovations innovations_of(const FixMeasurement& fix, const Matrix3d& covariance,
                                           double ahead_s) const;
  FixOutcome judge(const settings::Settings& settings, const FixMeasurement& fix);
  [[nodiscard]] int nearest_start(const Innovations& innovations) const;
  void note_used(const FixMeasurement& fix);
  void correct_candidates(const FixMeasurement& fix, const Matrix3d& covariance,
                          const Matrix3d& more_covariance, const Innovations& innovations, double ahead_s);
  void prune_starts();
  void search_yaw_again();
  void choose_model();
  void explain(const FixMeasurement& fix, const Matrix3d& covariance, const Innovations& innovations,
               double ahead_s);
  void correct_open(const Innovations& innovations, const Matrix3d& covariance);
  [[nodiscard]] int wrong_sensor() const;
  void doubt_imu(int model);
  void suspect_imu(bool is_suspicious);
  [[nodiscard]] bool has_open_models() const { return candidate_count == model_count; }
  void clone_best(Candidate& candidate);
  [[nodiscard]] bool trusts_imu_again(const Candidate& candidate) const;
  [[nodiscard]] bool rival_explains_better(const FixMeasurement& fix, const Matrix3d& covariance,
                                           double ahead_s, const Innovation& innovation) const;
  void reject(const settings::Settings& settings, const FixMeasurement& fix, const Matrix3d& covariance,
              double ahead_s, FixOutcome& outcome);
  bool rival_explains(const FixMeasurement& fix, const Matrix3d& covariance, double ahead_s,
                      FixOutcome& outcome);
  void learn_from_scatter(const FixMeasurement& fix, const Innovation& innovation);
  [[nodiscard]] bool has_just_jumped(TimeNs now_ns) const;
  void note_jump(TimeNs fix_ns);
  void widen_yaw(double std_rad);
  [[nodiscard]] double unexplained_s(int least_rejected, TimeNs now_ns) const;
  [[nodiscard]] bool all_starts_are_wrong(TimeNs now_ns) const;
  [[nodiscard]] bool must_start_again(TimeNs now_ns) const;
  [[nodiscard]] bool rival_has_won(TimeNs now_ns) const;
  void begin_rival(const FixMeasurement& fix, const Matrix3d& covariance);
  void end_rival(TimeNs now_ns);
  void drop_anchor(TimeNs now_ns);
  void keep_former(TimeNs left_ns, TimeNs left_for_ns);
  void promote_rival();
  bool take_back_former(const FixMeasurement& fix, const Matrix3d& covariance, double ahead_s);
  void adopt(const Filter& track);
  bool check_frozen(const settings::FrozenSettings& settings, const FixMeasurement& fix);
};

}  // namespace sonopose::estimation::kalman
