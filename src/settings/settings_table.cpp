/// Every setting: item, key, range, unit and meaning. The default is the one of the struct.

#include "settings/table_builder.hpp"

namespace sonopose::settings {
namespace {

using detail::Builder;

void add(Builder& table, const EngineSettings& settings) {
  table.group("fusion");
  table.choice(
      no_item, "engine", settings.engine,
      "Estimator: the one of the specification, or an error-state Kalman filter. A change starts the "
      "beacon's estimate again.");
}

void add(Builder& table, const PresetSettings& settings) {
  table.choice(1, "imu_weight", settings.imu_weight,
               "Balance of IMU and ultrasound: low follows the fixes closely, high is smooth and corrects "
               "slowly; user takes items 2, 3 and 4 as they are set.");
}

void add(Builder& table, const DriftSettings& settings) {
  table.group("drift");
  table.real(2, "decay_rate_hz", settings.decay_rate_hz, {0.0, 50.0}, "1/s",
             "Rate at which the offset between the IMU's path and the ultrasonic track is driven to zero.");
  table.real(4, "jump_alpha", settings.jump_alpha, {0.0, 1.0}, "",
             "Share of the discrepancy at a fix that is applied at once, scaled by the fix's weight.");
  table.real(9, "velocity_smooth_rate_hz", settings.velocity_smooth_rate_hz, {0.1, 200.0}, "1/s",
             "Smoothing rate of the drift velocity, the inner loop of the decay; it oscillates if item 2 "
             "exceeds a quarter of it.");
}

void add(Builder& table, const VelocitySettings& settings) {
  table.group("velocity");
  table.real(3, "blend_weight", settings.blend_weight, {0.0, 1.0}, "",
             "Largest share of the difference to the velocity between two fixes that one fix corrects; "
             "scaled by the fix's weight.");
  table.flag(7, "overshoot_fix", settings.overshoot_fix,
             "Take the ultrasonic velocity at once where the IMU's is more than twice as high in the same "
             "direction.");
  table.flag(8, "undershoot_fix", settings.undershoot_fix,
             "Take the ultrasonic velocity at once where it is more than twice the IMU's.");
  table.real(28, "snap_min_speed_mps", settings.snap_min_speed_mps, {0.0, 100.0}, "m/s",
             "Ultrasonic speed below which the overshoot and undershoot fixes never act.");
  table.real(no_item, "snap_max_bend_m", settings.snap_max_bend_m, {0.0, 100.0}, "m",
             "A fix farther than this from the straight continuation of the two before it never replaces the "
             "velocity at once: a single stray fix is not a speed.");
  table.flag(26, "accel_gate", settings.accel_gate,
             "Reduce the velocity correction in proportion to the current acceleration.");
  table.real(27, "accel_gate_threshold_mps2", settings.accel_gate_threshold_mps2, {0.01, 1000.0}, "m/s^2",
             "Acceleration at which the acceleration gate halves the correction; at twice this it is zero.");
  table.real(no_item, "interval_min_s", settings.interval_min_s, {0.001, 1.0}, "s",
             "Two fixes closer together than this give no velocity.");
  table.real(no_item, "interval_max_s", settings.interval_max_s, {0.01, 10.0}, "s",
             "Two fixes farther apart than this give no velocity.");
  table.real(no_item, "interval_wanted_s", settings.interval_wanted_s, {0.001, 10.0}, "s",
             "The velocity is measured from the latest earlier fix that lies this far back, else from the "
             "oldest: over a longer interval the fixes' noise counts less.");
}

void add(Builder& table, const AlignmentSettings& settings) {
  table.group("alignment");
  table.real(no_item, "tilt_gain_hz", settings.tilt_gain_hz, {0.0, 3.0}, "1/s",
             "Rate at which the velocity corrections by fixes level the attitude; 0 disables this.");
  table.real(no_item, "vertical_gain_hz", settings.vertical_gain_hz, {0.0, 3.0}, "1/s",
             "Rate at which vertical velocity corrections by fixes are learned as an offset of the vertical "
             "acceleration.");
  table.real(no_item, "vertical_limit_mps2", settings.vertical_limit_mps2, {0.0, 10.0}, "m/s^2",
             "Largest offset of the vertical acceleration that is learned.");
  table.real(no_item, "yaw_gain", settings.yaw_gain, {0.0, 1.0}, "",
             "Share of the angle between the acceleration seen by the IMU and by the fixes that one fix "
             "corrects in yaw, while there is no paired heading.");
  table.real(
      no_item, "yaw_noise_mps", settings.yaw_noise_mps, {0.05, 10.0}, "m/s",
      "Velocity gained by acceleration at which that share is halved; smaller gains are mostly noise.");
  table.real(no_item, "aiding_s", settings.aiding_s, {0.0, 120.0}, "s",
             "Time over which a velocity correction is passed to the attitude filter as known acceleration; "
             "0 passes none.");
  table.real(no_item, "hold_s", settings.hold_s, {0.0, 3600.0}, "s",
             "After the last known acceleration the attitude filter ignores the accelerometer for this long, "
             "because that sensor alone cannot distinguish motion from tilt.");
}

void add(Builder& table, const HeadingSettings& settings) {
  table.group("heading");
  table.read_by(ReadBy::all);
  table.real(
      5, "mount_offset_deg", settings.mount_offset_deg, {-360.0, 360.0}, "deg",
      "Angle from the body's X axis to the axis of the paired beacons; 90 if the pair lies along body Y.");
  table.read_by(ReadBy::documented);
  table.real(31, "min_displacement_m", settings.min_displacement_m, {0.0, 100.0}, "m",
             "Least distance between two fixes for a yaw correction from the direction of motion.");
  table.real(32, "max_correction_deg", settings.max_correction_deg, {0.0, 180.0}, "deg",
             "Largest yaw correction by one fix.");
  table.real(33, "error_gain", settings.error_gain, {0.0, 1.0}, "",
             "Share of the heading error that one fix corrects.");
  table.real(34, "pair_gain_hz", settings.pair_gain_hz, {0.0, 50.0}, "1/s",
             "Rate at which yaw is corrected to the heading of the paired beacons, at every IMU sample.");
  table.real(
      no_item, "pair_bias_gain_hz2", settings.pair_bias_gain_hz2, {0.0, 10.0}, "1/s^2",
      "Rate at which a yaw-rate offset is learned from that correction; the tilt's integral (item 30) cannot "
      "observe one. It is limited to what the correction (item 34) can damp, a quarter of its square.");
  table.real(no_item, "expires_s", settings.expires_s, {0.01, 60.0}, "s",
             "A paired heading is no longer valid this long after its last sample.");
}

void add(Builder& table, const DelaySettings& settings) {
  table.group("delay");
  table.read_by(ReadBy::all);
  table.flag(6, "extrapolate", settings.extrapolate,
             "Move a fix forward by its delay along the IMU's path, so that motion causes no step at a fix.");
  table.real(no_item, "processing_s", settings.processing_s, {0.0, 0.5}, "s",
             "Delay from ultrasound emission to receipt where the fix does not carry its own.");
  table.choice(no_item, "source", settings.source,
               "Which delay applies where a fix carries its own: that one, or the fixed one.");
  table.real(no_item, "correction_s", settings.correction_s, {-0.5, 0.5}, "s",
             "Added to the delay that fixes and headings carry: its constant error, which sonopose-calibrate "
             "estimates.");
  table.read_by(ReadBy::kalman);
  table.flag(no_item, "estimate", settings.estimate,
             "Estimate a constant error of that delay, of up to 0.3 s. It is observable only while the speed "
             "or the direction changes.");
}

void add(Builder& table, const OutageSettings& settings) {
  table.group("outage");
  table.read_by(ReadBy::documented);
  table.real(10, "velocity_decay_rate_hz", settings.velocity_decay_rate_hz, {0.0, 100.0}, "1/s",
             "Rate at which velocity falls to zero in stale mode.");
  table.read_by(ReadBy::all);
  table.real(11, "stale_after_s", settings.stale_after_s, {0.1, 60.0}, "s",
             "Without a valid fix for this long, stale mode begins. The documented engine no longer "
             "integrates the acceleration then.");
  table.real(no_item, "imu_gap_s", settings.imu_gap_s, {0.01, 5.0}, "s",
             "An IMU gap longer than this is not integrated over; the velocity only decays.");
}

void add(Builder& table, const AdmissionSettings& settings) {
  table.group("admission");
  table.real(12, "min_quality_percent", settings.min_quality_percent, {0.0, 100.0}, "%",
             "Fixes of a lower reported quality are not used; fixes without a quality are.");
  table.real(no_item, "max_position_m", settings.max_position_m, {1.0, 1e6}, "m",
             "A fix with a coordinate beyond this is rejected as invalid.");
  table.real(no_item, "max_specific_force_mps2", settings.max_specific_force_mps2, {20.0, 1e4}, "m/s^2",
             "An IMU sample with a specific force beyond this is rejected as invalid.");
  table.real(no_item, "max_angular_rate_radps", settings.max_angular_rate_radps, {5.0, 1e3}, "rad/s",
             "An IMU sample with an angular rate beyond this is rejected as invalid.");
  table.real(no_item, "max_fix_age_s", settings.max_fix_age_s, {0.1, 1.0}, "s",
             "A fix or heading is not used if it was measured longer ago than this, was in transit for "
             "longer, or lies in the future.");
}

void add(Builder& table, const TrustSettings& settings) {
  table.group("trust");
  table.real(13, "sigma_m", settings.sigma_m, {0.001, 10.0}, "m",
             "A fix this far from the velocity-predicted position has weight 0.5; farther, less.");
  table.real(14, "min_weight", settings.min_weight, {0.0, 1.0}, "",
             "Floor of the weight of any fix, however large its innovation.");
  table.flag(
      15, "enabled", settings.enabled,
      "After an outlier, compare fixes with the IMU's prediction and rebuild trust over consistent ones.");
  table.real(16, "reference_innovation_m", settings.reference_innovation_m, {0.01, 100.0}, "m",
             "A jump of this size takes n_base fixes to be trusted again; others in proportion.");
  table.count(17, "n_base", settings.n_base, {1, 1000}, "fixes",
              "Fixes that rebuild full trust after a jump of the reference size.");
  table.count(18, "n_min", settings.n_min, {1, 1000}, "fixes", "Least number of fixes that rebuild trust.");
  table.count(19, "n_max", settings.n_max, {1, 1000}, "fixes",
              "Most fixes that rebuild trust; after that many the track is accepted in any case.");
  table.count(20, "stuck_n", settings.stuck_n, {1, 1000}, "fixes",
              "Consecutive outliers at zero trust that force convergence.");
  table.real(21, "stuck_jump_scale", settings.stuck_jump_scale, {0.0, 1.0}, "",
             "Least share of the remaining error that is removed at each fix while convergence is forced.");
  table.real(22, "stuck_weight_floor", settings.stuck_weight_floor, {0.0, 1.0}, "",
             "Floor of the drift's weight while convergence is forced.");
  table.real(no_item, "outlier_sigmas", settings.outlier_sigmas, {0.5, 100.0}, "",
             "A fix whose innovation exceeds this many sigma_m is an outlier.");
}

void add(Builder& table, const RunawaySettings& settings) {
  table.group("runaway");
  table.real(23, "position_error_m", settings.position_error_m, {0.01, 1000.0}, "m",
             "Distance from the last fix that was no outlier beyond which a velocity that leads away from it "
             "is damped.");
  table.real(24, "velocity_damp_max_hz", settings.velocity_damp_max_hz, {0.0, 100.0}, "1/s",
             "Rate of that damping at twice the distance and beyond; it rises linearly from zero.");
}

void add(Builder& table, const MotionSettings& settings) {
  table.group("motion");
  table.real(25, "accel_linear_threshold_mps2", settings.accel_linear_threshold_mps2, {0.1, 1000.0}, "m/s^2",
             "World acceleration above which velocity is softly reduced.");
  table.flag(35, "gyro_gate", settings.gyro_gate,
             "Suppress acceleration while the body turns too fast for it to be the acceleration of the "
             "tracked point.");
  table.real(36, "gyro_gate_projection_radps", settings.gyro_gate_projection_radps, {0.0, 100.0}, "rad/s",
             "Angular rate above which only the acceleration along the velocity is integrated.");
  table.real(37, "gyro_gate_freeze_radps", settings.gyro_gate_freeze_radps, {0.0, 100.0}, "rad/s",
             "Angular rate above which no acceleration is integrated.");
}

void add(Builder& table, const attitude::SelectionSettings& settings) {
  table.group("attitude");
  table.choice(no_item, "filter", settings.filter, "Attitude filter; items 29 and 30 belong to mahony.");
  table.flag(no_item, "magnetometer", settings.magnetometer,
             "Use the magnetometer for the heading, if samples contain one; not with paired beacons, whose "
             "heading is more accurate.");
  table.real(no_item, "north_deg", settings.north_deg, {-360.0, 360.0}, "deg",
             "Direction of magnetic north in the world, counter-clockwise from +X: 90 where X is east, 0 "
             "where X is north.");
}

void add(Builder& table, const attitude::MahonySettings& settings) {
  table.group("attitude.mahony");
  table.real(29, "kp", settings.kp, {0.0, 10.0}, "1/s",
             "Speed at which tilt is corrected towards the measured gravity; higher reacts faster and is "
             "more easily misled by acceleration.");
  table.real(
      30, "ki", settings.ki, {0.0, 0.1}, "1/s^2",
      "Rate at which a remaining gyro offset is learned from the tilt correction, over tens of seconds.");
  table.real(no_item, "ki_gate_mps2", settings.ki_gate_mps2, {0.0, 1000.0}, "m/s^2",
             "The offset is learned only while the specific force differs from gravity by less than this: in "
             "a long turn the tilt correction is always wrong in the same direction.");
  table.choice(no_item, "magnetic_error", settings.magnetic_error,
               "What the magnetometer corrects: heading alone, or, as in the original filter, the full error "
               "of all three axes with the gain kp.");
  table.real(
      no_item, "heading_kp", settings.heading_kp, {0.0, 10.0}, "1/s",
      "Speed at which heading is corrected towards the magnetometer's, where it corrects heading alone.");
}

void add(Builder& table, const attitude::AdaptiveSettings& settings) {
  table.group("attitude.adaptive");
  table.real(no_item, "accel_time_s", settings.accel_time_s, {0.05, 1000.0}, "s",
             "Time constant of the specific force's low-pass: longer is misled less by acceleration and "
             "corrects the gyroscope later.");
  table.real(no_item, "heading_time_s", settings.heading_time_s, {0.05, 1000.0}, "s",
             "Time constant with which heading follows the magnetometer's.");
}

void add(Builder& table, const attitude::RestSettings& settings) {
  table.group("attitude.rest");
  table.real(no_item, "rate_limit_dps", settings.rate_limit_dps, {0.0, 100.0}, "deg/s",
             "At rest the angular rate stays within this of its mean.");
  table.real(no_item, "force_limit_mps2", settings.force_limit_mps2, {0.0, 10.0}, "m/s^2",
             "At rest the specific force stays within this of its mean.");
  table.real(no_item, "still_s", settings.still_s, {0.1, 60.0}, "s",
             "Rest is detected after both limits have been met for this long.");
  table.real(no_item, "smoothing_s", settings.smoothing_s, {0.01, 10.0}, "s",
             "Time constant of these means.");
}

void add(Builder& table, const attitude::BiasSettings& settings) {
  table.group("attitude.bias");
  table.real(no_item, "initial_dps", settings.initial_dps, {0.0, 100.0}, "deg/s",
             "Standard deviation of the gyroscope's offset at the start, and its upper limit.");
  table.real(no_item, "limit_dps", settings.limit_dps, {0.0, 100.0}, "deg/s",
             "Largest offset about one axis that is learned.");
  table.real(no_item, "wander_s", settings.wander_s, {1.0, 1e6}, "s",
             "Time in which the offset wanders by 0.1 deg/s.");
  table.real(no_item, "rest_dps", settings.rest_dps, {1e-4, 100.0}, "deg/s",
             "Standard deviation of the offset after long rest; higher learns more slowly.");
  table.real(no_item, "motion_dps", settings.motion_dps, {1e-4, 100.0}, "deg/s",
             "Standard deviation of the offset after long motion; higher learns more slowly.");
  table.real(no_item, "unseen_dps", settings.unseen_dps, {1e-4, 1000.0}, "deg/s",
             "The same about the vertical, where the offset is not observable in motion; lower pulls it "
             "towards zero more strongly.");
}

void add(Builder& table, const attitude::MagneticSettings& settings) {
  table.group("attitude.magnetic");
  table.real(no_item, "norm_tolerance", settings.norm_tolerance, {0.0, 1.0}, "",
             "A field is disturbed if its norm differs from the reference by more than this share.");
  table.real(no_item, "dip_tolerance_deg", settings.dip_tolerance_deg, {0.0, 90.0}, "deg",
             "A field is disturbed if its dip differs from the reference by more than this.");
  table.real(no_item, "undisturbed_s", settings.undisturbed_s, {0.0, 60.0}, "s",
             "A field counts as undisturbed again after it has matched the reference for this long.");
  table.real(
      no_item, "first_field_s", settings.first_field_s, {0.0, 600.0}, "s",
      "A field becomes the first reference after it has been constant for this long while the body turned.");
  table.real(
      no_item, "new_field_s", settings.new_field_s, {0.0, 600.0}, "s",
      "Another field becomes the reference after it has been constant for this long while the body turned.");
  table.real(no_item, "new_field_rate_dps", settings.new_field_rate_dps, {0.0, 1000.0}, "deg/s",
             "Only time at a higher angular rate than this counts as turning: at rest a nearby magnet looks "
             "like the local field.");
  table.real(no_item, "longest_rejection_s", settings.longest_rejection_s, {0.0, 3600.0}, "s",
             "A disturbed field is ignored for at most this long, then used with the weight late_share.");
  table.real(no_item, "late_share", settings.late_share, {0.0, 1.0}, "",
             "Weight of a field that has been disturbed for longer than that.");
  table.real(no_item, "reference_s", settings.reference_s, {0.1, 3600.0}, "s",
             "Time constant with which the reference follows an undisturbed field.");
  table.real(no_item, "smoothing_s", settings.smoothing_s, {0.0, 10.0}, "s",
             "Time constant of the mean of norm and dip.");
}

void add(Builder& table, const attitude::ComplementarySettings& settings) {
  table.group("attitude.complementary");
  table.real(no_item, "alpha", settings.alpha, {0.0, 1.0}, "",
             "Share of the gyroscope's prediction in the orientation; the rest is what accelerometer and "
             "magnetometer measure.");
  table.real(no_item, "alpha_step_s", settings.alpha_step_s, {1e-5, 10.0}, "s",
             "Time step that alpha applies to; over another step alpha is raised to the ratio of the two.");
}

void add(Builder& table, const attitude::AhrsSettings& settings) {
  table.group("attitude.ahrs");
  table.real(no_item, "gain", settings.gain, {0.0, 10.0}, "1/s",
             "Speed at which tilt and heading follow the accelerometer and the magnetometer; 0 is the "
             "gyroscope alone.");
  table.real(no_item, "acceleration_rejection_deg", settings.acceleration_rejection_deg, {0.0, 180.0}, "deg",
             "The accelerometer is ignored while its up is further than this from the estimated one; 0 never "
             "ignores it.");
  table.real(no_item, "magnetic_rejection_deg", settings.magnetic_rejection_deg, {0.0, 180.0}, "deg",
             "The magnetometer is ignored while its heading is further than this from the estimated one; 0 "
             "never ignores it.");
  table.real(no_item, "rejection_timeout_s", settings.rejection_timeout_s, {0.0, 3600.0}, "s",
             "How long a sensor may be ignored; 0 never ignores any.");
  table.choice(no_item, "rejection", settings.rejection,
               "After that time: recovery uses the sensor until it agrees, seed restarts the initialisation "
               "or sets the heading.");
  table.flag(no_item, "gyro_offset", settings.gyro_offset,
             "Learn the gyroscope's offset while the body stands still.");
  table.real(no_item, "gyro_offset_limit_dps", settings.gyro_offset_limit_dps, {0.0, 100.0}, "deg/s",
             "The body stands still while no rate, less the offset learned so far, exceeds this.");
  table.real(no_item, "gyro_offset_still_s", settings.gyro_offset_still_s, {0.0, 3600.0}, "s",
             "How long it must stand still before the offset is learned.");
  table.real(no_item, "gyro_offset_cutoff_hz", settings.gyro_offset_cutoff_hz, {1e-4, 10.0}, "Hz",
             "Cut-off of the low-pass filter that learns the offset.");
  table.real(no_item, "gyro_range_dps", settings.gyro_range_dps, {0.0, 1e5}, "deg/s",
             "Range of the gyroscope; a rate beyond 98 % of it, where the sensor may clip, restarts the "
             "initialisation; 0 disables this.");
}

void add(Builder& table, const StartupSettings& settings) {
  table.group("startup");
  table.real(
      no_item, "calibration_s", settings.calibration_s, {0.1, 30.0}, "s",
      "How long the body must be still for the gyro offset to be measured, and how long the start waits.");
  table.real(no_item, "still_gyro_std_radps", settings.still_gyro_std_radps, {0.0, 1.0}, "rad/s",
             "Spread of each gyro axis below which the body counts as still.");
  table.real(no_item, "still_accel_std_mps2", settings.still_accel_std_mps2, {0.0, 10.0}, "m/s^2",
             "Spread of each accelerometer axis below which the body counts as still.");
  table.real(no_item, "max_gyro_offset_radps", settings.max_gyro_offset_radps, {0.0, 1.0}, "rad/s",
             "A mean rate beyond this is a turn and not an offset.");
  table.real(no_item, "still_moved_m", settings.still_moved_m, {0.01, 100.0}, "m",
             "Fixes farther apart than this show motion, which an IMU cannot sense at constant velocity.");
}

void add(Builder& table, const FrozenSettings& settings) {
  table.group("frozen");
  table.real(no_item, "moved_m", settings.moved_m, {0.01, 10.0}, "m",
             "The track counts as frozen when the IMU has moved this far while the coordinates repeated.");
  table.real(
      no_item, "window_s", settings.window_s, {0.1, 10.0}, "s",
      "Time within which it must have moved that far; over a longer time the IMU's drift would count.");
  table.count(no_item, "repeats", settings.repeats, {1, 1000}, "fixes",
              "Least number of repetitions before a track can be called frozen.");
}

void add(Builder& table, const UncertaintySettings& settings) {
  table.group("uncertainty");
  table.real(no_item, "fix_std_m", settings.fix_std_m, {1e-4, 10.0}, "m",
             "Standard deviation of a fix of full weight, per axis.");
  table.real(no_item, "heading_std_deg", settings.heading_std_deg, {0.01, 180.0}, "deg",
             "Standard deviation of a paired heading.");
  table.real(no_item, "accel_std_mps2", settings.accel_std_mps2, {1e-3, 100.0}, "m/s^2",
             "Error of the world acceleration, tilt error included: the rate at which the velocity's "
             "standard deviation grows.");
  table.real(no_item, "yaw_drift_std_degps", settings.yaw_drift_std_degps, {1e-4, 100.0}, "deg/s",
             "Rate at which the yaw's standard deviation grows without a heading.");
}

void add(Builder& table, const OutputSettings& settings) {
  table.group("output");
  table.count(no_item, "rate_hz", settings.rate_hz, {0, 1000}, "Hz",
              "Rate of additional poses on a steady clock, predicted from the latest IMU sample; 0 publishes "
              "one pose per sample.");
}

void add(Builder& table, const calibration::AxesSettings& settings) {
  table.group("calibration");
  table.choice(no_item, "axes", settings.axes,
               "The sensor's axes along body X, Y and Z: with +y-x+z body X is the sensor's +Y, body Y its "
               "-X and body Z its +Z. Applies to gyroscope, accelerometer and magnetometer, after their "
               "calibration, which is in the sensor's axes.");
}

void add_inertial(Builder& table, const calibration::InertialTerms& settings) {
  const auto sensitivity = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {0.1, 10.0}, "", sentence);
  };
  const auto misalignment = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-0.5, 0.5}, "", sentence);
  };
  sensitivity("sensitivity_x", settings.sensitivity_x,
              "Factor of the sensor's X axis, after the offset was subtracted.");
  sensitivity("sensitivity_y", settings.sensitivity_y, "Factor of the sensor's Y axis.");
  sensitivity("sensitivity_z", settings.sensitivity_z, "Factor of the sensor's Z axis.");
  misalignment("misalignment_xy", settings.misalignment_xy,
               "Share of the Y axis, after its sensitivity, that is added to X.");
  misalignment("misalignment_xz", settings.misalignment_xz, "Share of the Z axis that is added to X.");
  misalignment("misalignment_yx", settings.misalignment_yx, "Share of the X axis that is added to Y.");
  misalignment("misalignment_yz", settings.misalignment_yz, "Share of the Z axis that is added to Y.");
  misalignment("misalignment_zx", settings.misalignment_zx, "Share of the X axis that is added to Z.");
  misalignment("misalignment_zy", settings.misalignment_zy, "Share of the Y axis that is added to Z.");
}

void add(Builder& table, const calibration::GyroscopeSettings& settings) {
  table.group("calibration.gyroscope");
  const auto offset = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-2.0, 2.0}, "rad/s", sentence);
  };
  offset("offset_x_radps", settings.offset_x_radps,
         "Output of the sensor's X axis at rest, subtracted first; the engine estimates the remainder.");
  offset("offset_y_radps", settings.offset_y_radps, "Output of the sensor's Y axis at rest.");
  offset("offset_z_radps", settings.offset_z_radps, "Output of the sensor's Z axis at rest.");
  add_inertial(table, settings);
}

void add(Builder& table, const calibration::AccelerometerSettings& settings) {
  table.group("calibration.accelerometer");
  const auto offset = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-20.0, 20.0}, "m/s^2", sentence);
  };
  offset("offset_x_mps2", settings.offset_x_mps2,
         "Output of the sensor's X axis in free fall, subtracted first.");
  offset("offset_y_mps2", settings.offset_y_mps2, "Output of the sensor's Y axis in free fall.");
  offset("offset_z_mps2", settings.offset_z_mps2, "Output of the sensor's Z axis in free fall.");
  add_inertial(table, settings);
}

void add(Builder& table, const calibration::MagnetometerSettings& settings) {
  table.group("calibration.magnetometer");
  const auto diagonal = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {0.01, 100.0}, "", sentence);
  };
  const auto off_diagonal = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-100.0, 100.0}, "", sentence);
  };
  const auto offset = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-10000.0, 10000.0}, "uT", sentence);
  };
  diagonal("soft_iron_xx", settings.soft_iron_xx,
           "Soft-iron matrix, which is symmetric: factor of the sensor's X axis.");
  off_diagonal("soft_iron_xy", settings.soft_iron_xy, "Soft-iron matrix: share of Y in X and of X in Y.");
  off_diagonal("soft_iron_xz", settings.soft_iron_xz, "Soft-iron matrix: share of Z in X and of X in Z.");
  diagonal("soft_iron_yy", settings.soft_iron_yy, "Soft-iron matrix: factor of the sensor's Y axis.");
  off_diagonal("soft_iron_yz", settings.soft_iron_yz, "Soft-iron matrix: share of Z in Y and of Y in Z.");
  diagonal("soft_iron_zz", settings.soft_iron_zz, "Soft-iron matrix: factor of the sensor's Z axis.");
  offset("hard_iron_x_ut", settings.hard_iron_x_ut,
         "Hard-iron offset of the sensor's X axis, subtracted after the soft-iron matrix.");
  offset("hard_iron_y_ut", settings.hard_iron_y_ut, "Hard-iron offset of the sensor's Y axis.");
  offset("hard_iron_z_ut", settings.hard_iron_z_ut, "Hard-iron offset of the sensor's Z axis.");
}

}  // namespace

void detail::add_all(Builder& table, const Settings& settings) {
  add(table, settings.engine);
  table.read_by(ReadBy::documented);
  add(table, settings.preset);
  add(table, settings.drift);
  add(table, settings.velocity);
  add(table, settings.alignment);
  add(table, settings.heading);
  add(table, settings.delay);
  add(table, settings.outage);
  table.read_by(ReadBy::all);
  add(table, settings.admission);
  table.read_by(ReadBy::documented);
  add(table, settings.trust);
  add(table, settings.runaway);
  add(table, settings.motion);
  add(table, settings.attitude.selection);
  add(table, settings.attitude.mahony);
  add(table, settings.attitude.adaptive.adaptive);
  add(table, settings.attitude.adaptive.rest);
  add(table, settings.attitude.adaptive.bias);
  add(table, settings.attitude.adaptive.magnetic);
  add(table, settings.attitude.complementary);
  add(table, settings.attitude.ahrs);
  add(table, settings.startup);
  table.read_by(ReadBy::all);
  add(table, settings.frozen);
  table.read_by(ReadBy::documented);
  add(table, settings.uncertainty);
  table.read_by(ReadBy::all);
  add(table, settings.output);
  add(table, settings.calibration.axes);
  add(table, settings.calibration.gyroscope);
  add(table, settings.calibration.accelerometer);
  table.read_by(ReadBy::documented);
  add(table, settings.calibration.magnetometer);
}

}  // namespace sonopose::settings
