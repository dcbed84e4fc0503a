/// Every setting: item, key, range, unit and meaning. The default is that of the struct.

#include "settings/table_builder.hpp"

namespace sonopose::settings {
namespace {

using detail::Builder;

void add(Builder& table, const EngineSettings& settings) {
  table.group("fusion");
  table.choice(no_item, "engine", settings.engine,
               "Estimator: that of the specification, or an error-state Kalman filter. A change restarts the "
               "beacon's estimate.");
}

void add(Builder& table, const PresetSettings& settings) {
  table.group("");
  table.choice(1, "imu_weight", settings.imu_weight,
               "Balance of IMU and ultrasound. low follows the fixes closely; high corrects slowly and "
               "smoothly. Only user applies items 2, 3 and 4.");
}

void add(Builder& table, const DriftSettings& settings) {
  table.group("drift");
  table.real(2, "decay_rate_hz", settings.decay_rate_hz, {0.0, 50.0}, "1/s",
             "Rate at which the offset between pose and fixes decays.");
  table.real(4, "jump_alpha", settings.jump_alpha, {0.0, 1.0}, "",
             "Share of the position error that a fix corrects immediately, times its weight.");
  table.real(9, "velocity_smooth_rate_hz", settings.velocity_smooth_rate_hz, {0.1, 200.0}, "1/s",
             "Smoothing rate of the correction velocity of item 2. The position oscillates if item 2 exceeds "
             "a quarter of this.");
}

void add(Builder& table, const VelocitySettings& settings) {
  table.group("velocity");
  table.real(3, "blend_weight", settings.blend_weight, {0.0, 1.0}, "",
             "Share of the velocity error that a fix corrects, times its weight. The first fixes correct "
             "more. 0 disables this.");
  table.flag(7, "overshoot_fix", settings.overshoot_fix,
             "Adopt the ultrasonic velocity if the IMU's is over twice as high in the same direction.");
  table.flag(8, "undershoot_fix", settings.undershoot_fix,
             "Adopt the ultrasonic velocity if it is over twice the IMU's.");
  table.real(28, "snap_min_speed_mps", settings.snap_min_speed_mps, {0.0, 100.0}, "m/s",
             "Items 7 and 8 need at least this ultrasonic speed.");
  table.real(no_item, "snap_max_bend_m", settings.snap_max_bend_m, {0.0, 100.0}, "m",
             "Items 7 and 8 ignore a stray fix: one farther than this from the extrapolated previous two.");
  table.flag(26, "accel_gate", settings.accel_gate,
             "Reduce velocity corrections in proportion to the current acceleration.");
  table.real(27, "accel_gate_threshold_mps2", settings.accel_gate_threshold_mps2, {0.01, 1000.0}, "m/s^2",
             "Item 26 halves corrections at this acceleration and stops them at twice it.");
  table.real(no_item, "interval_min_s", settings.interval_min_s, {0.001, 1.0}, "s",
             "Two fixes closer in time give no velocity.");
  table.real(no_item, "interval_max_s", settings.interval_max_s, {0.01, 10.0}, "s",
             "Two fixes farther apart in time give no velocity.");
  table.real(no_item, "interval_wanted_s", settings.interval_wanted_s, {0.001, 10.0}, "s",
             "Fixes measure velocity over at least this interval, else over the longest available. Longer "
             "reduces noise.");
}

void add(Builder& table, const AlignmentSettings& settings) {
  table.group("alignment");
  table.real(no_item, "tilt_gain_hz", settings.tilt_gain_hz, {0.0, 3.0}, "1/s",
             "Rate at which velocity corrections by fixes level the attitude. 0 disables this.");
  table.real(no_item, "vertical_gain_hz", settings.vertical_gain_hz, {0.0, 3.0}, "1/s",
             "Rate at which vertical velocity corrections teach an offset of the vertical acceleration.");
  table.real(no_item, "vertical_limit_mps2", settings.vertical_limit_mps2, {0.0, 10.0}, "m/s^2",
             "Largest learned offset of the vertical acceleration.");
  table.real(no_item, "yaw_gain", settings.yaw_gain, {0.0, 1.0}, "",
             "Share of the yaw error between IMU and fix accelerations that a fix corrects. Off with a "
             "paired or magnetic heading.");
  table.real(no_item, "yaw_noise_mps", settings.yaw_noise_mps, {0.05, 10.0}, "m/s",
             "Velocity gained by acceleration that halves yaw_gain. Smaller gains are mostly noise.");
  table.real(no_item, "aiding_s", settings.aiding_s, {0.0, 120.0}, "s",
             "Time over which the attitude filter gets a velocity correction as known acceleration. 0 "
             "disables this.");
  table.real(no_item, "hold_s", settings.hold_s, {0.0, 3600.0}, "s",
             "Ignore the accelerometer this long after the last known acceleration. Alone, it cannot "
             "distinguish motion from tilt.");
}

void add(Builder& table, const HeadingSettings& settings) {
  table.group("heading");
  table.read_by(ReadBy::all);
  table.real(5, "mount_offset_deg", settings.mount_offset_deg, {-360.0, 360.0}, "deg",
             "Angle from body X to the axis of the paired beacons. 90 if they lie along body Y.");
  table.read_by(ReadBy::documented);
  table.real(31, "min_displacement_m", settings.min_displacement_m, {0.0, 100.0}, "m",
             "Minimum distance between fixes that correct yaw by direction of motion. A pair heading "
             "disables this.");
  table.real(32, "max_correction_deg", settings.max_correction_deg, {0.0, 180.0}, "deg",
             "Largest yaw correction by one fix from the direction of motion.");
  table.real(33, "error_gain", settings.error_gain, {0.0, 1.0}, "",
             "Share of the error against the direction of motion that a fix corrects in yaw.");
  table.real(34, "pair_gain_hz", settings.pair_gain_hz, {0.0, 50.0}, "1/s",
             "Rate at which every IMU sample corrects yaw towards the pair heading.");
  table.real(no_item, "pair_bias_gain_hz2", settings.pair_bias_gain_hz2, {0.0, 10.0}, "1/s^2",
             "Rate at which the pair heading teaches a yaw-rate offset, which item 30 cannot observe. "
             "Limited to a quarter of item 34 squared.");
  table.real(no_item, "expires_s", settings.expires_s, {0.01, 60.0}, "s",
             "Time that a pair heading stays valid after its last sample.");
}

void add(Builder& table, const DelaySettings& settings) {
  table.group("delay");
  table.read_by(ReadBy::all);
  table.flag(6, "extrapolate", settings.extrapolate,
             "Compensate the delay of fixes by the IMU's path. Otherwise, motion causes a step at each fix.");
  table.real(no_item, "processing_s", settings.processing_s, {0.0, 0.5}, "s",
             "Delay from ultrasound emission to receipt, if a fix carries none or source is fixed.");
  table.choice(no_item, "source", settings.source,
               "measured uses the delay that a fix carries. fixed always uses processing_s.");
  table.real(
      no_item, "correction_s", settings.correction_s, {-0.5, 0.5}, "s",
      "Constant error, added to the delays that fixes and headings carry. sonopose-calibrate estimates it.");
  table.read_by(ReadBy::kalman);
  table.flag(no_item, "estimate", settings.estimate,
             "Estimate a constant delay error of up to 0.3 s. Only changes of speed or direction reveal it.");
}

void add(Builder& table, const TwistSettings& settings) {
  table.group("twist");
  table.read_by(ReadBy::kalman);
  table.flag(no_item, "enabled", settings.enabled,
             "Use measured velocities, as of wheels, where there are any.");
  table.real(no_item, "std_mps", settings.std_mps, {0.005, 10.0}, "m/s",
             "Standard deviation of a measured velocity whose source states none.");
  table.real(no_item, "lateral_std_mps", settings.lateral_std_mps, {0.0, 10.0}, "m/s",
             "Standard deviation of no motion to the side, while forward speed is measured alone. 0 disables "
             "this. For vehicles that cannot move sideways.");
  table.real(no_item, "vertical_std_mps", settings.vertical_std_mps, {0.0, 10.0}, "m/s",
             "Standard deviation of no motion along body Z, likewise.");
  table.real(no_item, "point_x_m", settings.point_x_m, {-10.0, 10.0}, "m",
             "Place whose velocity is measured, forward of the tracked point: the fixed axle.");
  table.real(no_item, "point_y_m", settings.point_y_m, {-10.0, 10.0}, "m",
             "That place, to the left of the tracked point.");
  table.real(no_item, "scale_std", settings.scale_std, {0.0, 0.2}, "",
             "Standard deviation of the unknown scale error, which is estimated. 0: the scale is exact.");
}

void add(Builder& table, const OutageSettings& settings) {
  table.group("outage");
  table.read_by(ReadBy::documented);
  table.real(10, "velocity_decay_rate_hz", settings.velocity_decay_rate_hz, {0.0, 100.0}, "1/s",
             "Rate at which velocity decays in stale mode and IMU gaps.");
  table.read_by(ReadBy::all);
  table.real(11, "stale_after_s", settings.stale_after_s, {0.1, 60.0}, "s",
             "Time without a valid fix until stale mode begins. The documented engine then stops integrating "
             "acceleration.");
  table.real(no_item, "imu_gap_s", settings.imu_gap_s, {0.01, 5.0}, "s",
             "Longer IMU gaps are not integrated. The velocity only decays.");
}

void add(Builder& table, const AdmissionSettings& settings) {
  table.group("admission");
  table.real(12, "min_quality_percent", settings.min_quality_percent, {0.0, 100.0}, "%",
             "Reject fixes of lower reported quality. Fixes without a quality pass.");
  table.real(no_item, "max_position_m", settings.max_position_m, {1.0, 1e6}, "m",
             "Reject fixes with a larger coordinate.");
  table.real(no_item, "max_specific_force_mps2", settings.max_specific_force_mps2, {20.0, 1e4}, "m/s^2",
             "Reject IMU samples with a larger specific force.");
  table.real(no_item, "max_angular_rate_radps", settings.max_angular_rate_radps, {5.0, 1e3}, "rad/s",
             "Reject IMU samples with a larger angular rate.");
  table.real(no_item, "max_fix_age_s", settings.max_fix_age_s, {0.1, 1.0}, "s",
             "Reject fixes and headings that are older, were longer in transit, or lie in the future.");
}

void add(Builder& table, const TrustSettings& settings) {
  table.group("trust");
  table.real(13, "sigma_m", settings.sigma_m, {0.001, 10.0}, "m",
             "Distance from its predicted position at which a fix has weight 0.5. Farther fixes count less.");
  table.real(14, "min_weight", settings.min_weight, {0.0, 1.0}, "",
             "Minimum weight of a fix, however large its innovation.");
  table.flag(15, "enabled", settings.enabled,
             "After an outlier, compare fixes with the IMU's prediction. Consistent fixes rebuild trust.");
  table.real(16, "reference_innovation_m", settings.reference_innovation_m, {0.01, 100.0}, "m",
             "Jump after which n_base fixes rebuild trust. Other jumps need proportionally many.");
  table.count(17, "n_base", settings.n_base, {1, 1000}, "fixes",
              "Fixes that rebuild full trust after the reference jump (item 16).");
  table.count(18, "n_min", settings.n_min, {1, 1000}, "fixes", "Fewest fixes that rebuild trust.");
  table.count(19, "n_max", settings.n_max, {1, 1000}, "fixes",
              "Most fixes that rebuild trust. After that, the track is accepted anyway.");
  table.count(
      20, "stuck_n", settings.stuck_n, {1, 1000}, "fixes",
      "More consecutive outliers than this at zero trust force convergence. Effective only below item 19.");
  table.real(21, "stuck_jump_scale", settings.stuck_jump_scale, {0.0, 1.0}, "",
             "Minimum share of the remaining error that a fix removes during forced convergence.");
  table.real(22, "stuck_weight_floor", settings.stuck_weight_floor, {0.0, 1.0}, "",
             "Minimum weight of drift and velocity corrections during forced convergence.");
  table.real(no_item, "outlier_sigmas", settings.outlier_sigmas, {0.5, 100.0}, "",
             "A fix is an outlier if its innovation exceeds this many sigma_m.");
}

void add(Builder& table, const RunawaySettings& settings) {
  table.group("runaway");
  table.real(23, "position_error_m", settings.position_error_m, {0.01, 1000.0}, "m",
             "Distance from the last non-outlier fix beyond which velocity that leads away is damped.");
  table.real(24, "velocity_damp_max_hz", settings.velocity_damp_max_hz, {0.0, 100.0}, "1/s",
             "Damping rate at twice item 23 and beyond. It rises linearly from zero.");
}

void add(Builder& table, const MotionSettings& settings) {
  table.group("motion");
  table.real(25, "accel_linear_threshold_mps2", settings.accel_linear_threshold_mps2, {0.1, 1000.0}, "m/s^2",
             "World acceleration above which velocity is softly reduced.");
  table.flag(35, "gyro_gate", settings.gyro_gate,
             "Suppress the IMU's acceleration in fast rotation, because it is not the tracked point's.");
  table.real(36, "gyro_gate_projection_radps", settings.gyro_gate_projection_radps, {0.0, 100.0}, "rad/s",
             "Above this angular rate, integrate only acceleration along the velocity.");
  table.real(37, "gyro_gate_freeze_radps", settings.gyro_gate_freeze_radps, {0.0, 100.0}, "rad/s",
             "Above this angular rate, integrate no acceleration.");
}

void add(Builder& table, const PlanarSettings& settings) {
  table.group("motion");
  table.flag(no_item, "planar", settings.planar,
             "The body stays in a horizontal plane: its height, roll, pitch and vertical speed are held. The "
             "documented engine only holds the height.");
  table.choice(no_item, "height_from", settings.height_from,
               "Height of a planar body. setting ignores that of fixes; fixes averages it.");
  table.real(no_item, "height_m", settings.height_m, {-1e4, 1e4}, "m",
             "Height of the tracked point of a planar body, if it is not from fixes.");
  table.real(no_item, "height_std_m", settings.height_std_m, {0.001, 10.0}, "m",
             "Standard deviation of that height: the unevenness of the floor.");
  table.real(no_item, "tilt_std_deg", settings.tilt_std_deg, {0.05, 30.0}, "deg",
             "Standard deviation of roll and pitch of a planar body, and of the slope of its floor.");
  table.flag(no_item, "output_flat", settings.output_flat,
             "Output height, roll, pitch and vertical speed of a planar body as 0.");
}

void add(Builder& table, const attitude::SelectionSettings& settings) {
  table.group("attitude");
  table.choice(no_item, "filter", settings.filter,
               "Attitude filter. Items 29 and 30 belong to mahony; rest, bias and magnetic to adaptive.");
  table.flag(no_item, "magnetometer", settings.magnetometer,
             "Use the magnetometer for heading, if samples contain one. Leave it off with paired beacons, "
             "whose heading is more accurate.");
  table.real(
      no_item, "north_deg", settings.north_deg, {-360.0, 360.0}, "deg",
      "Direction of magnetic north, counter-clockwise from world X. 90 if X is east, 0 if X is north.");
}

void add(Builder& table, const attitude::MahonySettings& settings) {
  table.group("attitude.mahony");
  table.real(29, "kp", settings.kp, {0.0, 10.0}, "1/s",
             "Rate at which tilt follows the measured gravity. Higher reacts faster, but acceleration "
             "misleads it more.");
  table.real(30, "ki", settings.ki, {0.0, 0.1}, "1/s^2",
             "Rate at which tilt and magnetic corrections teach the remaining gyroscope offset.");
  table.real(no_item, "ki_gate_mps2", settings.ki_gate_mps2, {0.0, 1000.0}, "m/s^2",
             "Tilt teaches the offset only while specific force and gravity differ by less. Long turns would "
             "teach a wrong one.");
  table.choice(no_item, "magnetic_error", settings.magnetic_error,
               "heading corrects heading alone. full corrects all three axes with gain kp, as in the "
               "original filter.");
  table.real(no_item, "heading_kp", settings.heading_kp, {0.0, 10.0}, "1/s",
             "Rate at which heading follows the magnetometer if magnetic_error is heading.");
}

void add(Builder& table, const attitude::AdaptiveSettings& settings) {
  table.group("attitude.adaptive");
  table.real(no_item, "accel_time_s", settings.accel_time_s, {0.05, 1000.0}, "s",
             "Low-pass time constant of the specific force. Longer resists acceleration better but corrects "
             "the gyroscope later.");
  table.real(no_item, "heading_time_s", settings.heading_time_s, {0.05, 1000.0}, "s",
             "Time constant with which heading follows the magnetometer.");
}

void add(Builder& table, const attitude::RestSettings& settings) {
  table.group("attitude.rest");
  table.real(no_item, "rate_limit_dps", settings.rate_limit_dps, {0.0, 100.0}, "deg/s",
             "At rest, the angular rate stays this close to its mean.");
  table.real(no_item, "force_limit_mps2", settings.force_limit_mps2, {0.0, 10.0}, "m/s^2",
             "At rest, the specific force stays this close to its mean.");
  table.real(no_item, "still_s", settings.still_s, {0.1, 60.0}, "s",
             "Rest is detected after this time within both limits.");
  table.real(no_item, "smoothing_s", settings.smoothing_s, {0.01, 10.0}, "s", "Time constant of both means.");
}

void add(Builder& table, const attitude::BiasSettings& settings) {
  table.group("attitude.bias");
  table.real(no_item, "initial_dps", settings.initial_dps, {0.0, 100.0}, "deg/s",
             "Initial and largest standard deviation of the gyroscope offset.");
  table.real(no_item, "limit_dps", settings.limit_dps, {0.0, 100.0}, "deg/s",
             "Largest learned offset per axis. A larger mean rate is not rest.");
  table.real(no_item, "wander_s", settings.wander_s, {1.0, 1e6}, "s",
             "Time in which the offset wanders by 0.1 deg/s.");
  table.real(no_item, "rest_dps", settings.rest_dps, {1e-4, 100.0}, "deg/s",
             "Standard deviation of the offset after long rest. Higher learns more slowly.");
  table.real(no_item, "motion_dps", settings.motion_dps, {1e-4, 100.0}, "deg/s",
             "Standard deviation of the offset after long motion. Higher learns more slowly.");
  table.real(no_item, "unseen_dps", settings.unseen_dps, {1e-4, 1000.0}, "deg/s",
             "The same about the vertical, where motion does not reveal the offset. Lower pulls it more "
             "strongly to zero.");
}

void add(Builder& table, const attitude::MagneticSettings& settings) {
  table.group("attitude.magnetic");
  table.real(no_item, "norm_tolerance", settings.norm_tolerance, {0.0, 1.0}, "",
             "Largest relative deviation of an undisturbed field's norm from the reference.");
  table.real(no_item, "dip_tolerance_deg", settings.dip_tolerance_deg, {0.0, 90.0}, "deg",
             "Largest deviation of an undisturbed field's dip from the reference.");
  table.real(no_item, "undisturbed_s", settings.undisturbed_s, {0.0, 60.0}, "s",
             "Time a field must match the reference to count as undisturbed again.");
  table.real(no_item, "first_field_s", settings.first_field_s, {0.0, 600.0}, "s",
             "Turning time until a constant field becomes the first reference.");
  table.real(no_item, "new_field_s", settings.new_field_s, {0.0, 600.0}, "s",
             "Turning time until another constant field becomes the reference.");
  table.real(
      no_item, "new_field_rate_dps", settings.new_field_rate_dps, {0.0, 1000.0}, "deg/s",
      "Minimum angular rate that counts as turning. At rest, a nearby magnet looks like the local field.");
  table.real(no_item, "longest_rejection_s", settings.longest_rejection_s, {0.0, 3600.0}, "s",
             "Longest time to ignore a disturbed field. Then it has the weight late_share.");
  table.real(no_item, "late_share", settings.late_share, {0.0, 1.0}, "",
             "Weight of a field disturbed for longer, and of fields before the first reference.");
  table.real(no_item, "reference_s", settings.reference_s, {0.1, 3600.0}, "s",
             "Time constant with which the reference follows an undisturbed field.");
  table.real(no_item, "smoothing_s", settings.smoothing_s, {0.0, 10.0}, "s",
             "Smoothing time constant of norm and dip.");
}

void add(Builder& table, const attitude::ComplementarySettings& settings) {
  table.group("attitude.complementary");
  table.real(no_item, "alpha", settings.alpha, {0.0, 1.0}, "",
             "Share of the gyroscope's prediction in the orientation. Accelerometer and magnetometer give "
             "the rest.");
  table.real(no_item, "alpha_step_s", settings.alpha_step_s, {1e-5, 10.0}, "s",
             "Time step that alpha applies to. A step dt uses alpha^(dt/alpha_step_s).");
}

void add(Builder& table, const attitude::AhrsSettings& settings) {
  table.group("attitude.ahrs");
  table.real(
      no_item, "gain", settings.gain, {0.0, 10.0}, "1/s",
      "Rate at which tilt and heading follow accelerometer and magnetometer. 0 uses the gyroscope alone.");
  table.real(no_item, "acceleration_rejection_deg", settings.acceleration_rejection_deg, {0.0, 180.0}, "deg",
             "Ignore the accelerometer while its up differs more from the estimate. 0 never ignores it.");
  table.real(no_item, "magnetic_rejection_deg", settings.magnetic_rejection_deg, {0.0, 180.0}, "deg",
             "Ignore the magnetometer while its heading differs more from the estimate. 0 never ignores it.");
  table.real(no_item, "rejection_timeout_s", settings.rejection_timeout_s, {0.0, 3600.0}, "s",
             "Longest time to ignore a sensor. 0 never ignores any.");
  table.choice(no_item, "rejection", settings.rejection,
               "After that time, recovery uses the sensor until it agrees. seed restarts initialisation "
               "(accelerometer) or sets the heading (magnetometer).");
  table.flag(no_item, "gyro_offset", settings.gyro_offset,
             "Learn the gyroscope offset while the body is still.");
  table.real(no_item, "gyro_offset_limit_dps", settings.gyro_offset_limit_dps, {0.0, 100.0}, "deg/s",
             "The body is still while no rate, less the learned offset, exceeds this.");
  table.real(no_item, "gyro_offset_still_s", settings.gyro_offset_still_s, {0.0, 3600.0}, "s",
             "Time the body must be still before learning.");
  table.real(no_item, "gyro_offset_cutoff_hz", settings.gyro_offset_cutoff_hz, {1e-4, 10.0}, "Hz",
             "Cut-off of the low-pass filter that learns the offset.");
  table.real(
      no_item, "gyro_range_dps", settings.gyro_range_dps, {0.0, 1e5}, "deg/s",
      "Gyroscope range. Rates beyond 98 % of it may be clipped and restart initialisation. 0 disables this.");
}

void add(Builder& table, const StartupSettings& settings) {
  table.group("startup");
  table.real(no_item, "calibration_s", settings.calibration_s, {0.1, 30.0}, "s",
             "Time the body must be still to measure the gyroscope offset. The start waits this long.");
  table.real(no_item, "still_gyro_std_radps", settings.still_gyro_std_radps, {0.0, 1.0}, "rad/s",
             "Largest spread of each gyro axis while still.");
  table.real(no_item, "still_accel_std_mps2", settings.still_accel_std_mps2, {0.0, 10.0}, "m/s^2",
             "Largest spread of each accelerometer axis while still.");
  table.real(no_item, "max_gyro_offset_radps", settings.max_gyro_offset_radps, {0.0, 1.0}, "rad/s",
             "A larger mean rate is a turn, not an offset.");
  table.real(no_item, "still_moved_m", settings.still_moved_m, {0.01, 100.0}, "m",
             "Fixes farther apart show motion. An IMU cannot sense constant velocity.");
}

void add(Builder& table, const FrozenSettings& settings) {
  table.group("frozen");
  table.real(no_item, "moved_m", settings.moved_m, {0.01, 10.0}, "m",
             "The track is frozen if the IMU moves this far while coordinates repeat.");
  table.real(no_item, "window_s", settings.window_s, {0.1, 10.0}, "s",
             "Time within which it must move that far. Over a longer time, IMU drift would count.");
  table.count(no_item, "repeats", settings.repeats, {1, 1000}, "fixes",
              "Fewest repetitions in a frozen track.");
}

void add(Builder& table, const UncertaintySettings& settings) {
  table.group("uncertainty");
  table.real(no_item, "fix_std_m", settings.fix_std_m, {1e-4, 10.0}, "m",
             "Standard deviation of a fix of full weight, per axis.");
  table.real(no_item, "heading_std_deg", settings.heading_std_deg, {0.01, 180.0}, "deg",
             "Standard deviation of a pair heading.");
  table.real(no_item, "accel_std_mps2", settings.accel_std_mps2, {1e-3, 100.0}, "m/s^2",
             "World acceleration error, including tilt error. The velocity's standard deviation grows at "
             "this rate.");
  table.real(no_item, "yaw_drift_std_degps", settings.yaw_drift_std_degps, {1e-4, 100.0}, "deg/s",
             "Growth rate of the yaw's standard deviation without a heading.");
}

void add(Builder& table, const OutputSettings& settings) {
  table.group("output");
  table.count(no_item, "rate_hz", settings.rate_hz, {0, 1000}, "Hz",
              "Rate of additional poses on a steady clock, predicted from the latest IMU sample. 0 publishes "
              "one pose per sample.");
}

void add(Builder& table, const calibration::AxesSettings& settings) {
  table.group("calibration");
  table.choice(no_item, "axes", settings.axes,
               "Sensor axes along body X, Y and Z. With +y-x+z, body X is sensor +Y and body Y sensor -X. "
               "Applies to gyroscope, accelerometer and magnetometer, after calibration in sensor axes.");
}

void add_inertial(Builder& table, const calibration::InertialTerms& settings) {
  const auto sensitivity = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {0.01, 10.0}, "", sentence);  // deg/s and g can be converted
  };
  const auto misalignment = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-0.5, 0.5}, "", sentence);
  };
  sensitivity("sensitivity_x", settings.sensitivity_x, "Factor of sensor axis X, after the offset.");
  sensitivity("sensitivity_y", settings.sensitivity_y, "Factor of sensor axis Y.");
  sensitivity("sensitivity_z", settings.sensitivity_z, "Factor of sensor axis Z.");
  misalignment("misalignment_xy", settings.misalignment_xy, "Share of Y, after its sensitivity, added to X.");
  misalignment("misalignment_xz", settings.misalignment_xz, "Share of Z added to X.");
  misalignment("misalignment_yx", settings.misalignment_yx, "Share of X added to Y.");
  misalignment("misalignment_yz", settings.misalignment_yz, "Share of Z added to Y.");
  misalignment("misalignment_zx", settings.misalignment_zx, "Share of X added to Z.");
  misalignment("misalignment_zy", settings.misalignment_zy, "Share of Y added to Z.");
}

void add(Builder& table, const calibration::GyroscopeSettings& settings) {
  table.group("calibration.gyroscope");
  const auto offset = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-2.0, 2.0}, "rad/s", sentence);
  };
  offset("offset_x_radps", settings.offset_x_radps,
         "Output of sensor axis X at rest, subtracted first. The engine estimates the remainder.");
  offset("offset_y_radps", settings.offset_y_radps, "Output of sensor axis Y at rest.");
  offset("offset_z_radps", settings.offset_z_radps, "Output of sensor axis Z at rest.");
  add_inertial(table, settings);
}

void add(Builder& table, const calibration::AccelerometerSettings& settings) {
  table.group("calibration.accelerometer");
  const auto offset = [&table](std::string_view name, const double& field, std::string_view sentence) {
    table.real(no_item, name, field, {-20.0, 20.0}, "m/s^2", sentence);
  };
  offset("offset_x_mps2", settings.offset_x_mps2, "Output of sensor axis X in free fall, subtracted first.");
  offset("offset_y_mps2", settings.offset_y_mps2, "Output of sensor axis Y in free fall.");
  offset("offset_z_mps2", settings.offset_z_mps2, "Output of sensor axis Z in free fall.");
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
  diagonal("soft_iron_xx", settings.soft_iron_xx, "Symmetric soft-iron matrix: factor of sensor axis X.");
  off_diagonal("soft_iron_xy", settings.soft_iron_xy, "Soft-iron share of Y in X and X in Y.");
  off_diagonal("soft_iron_xz", settings.soft_iron_xz, "Soft-iron share of Z in X and X in Z.");
  diagonal("soft_iron_yy", settings.soft_iron_yy, "Soft-iron factor of sensor axis Y.");
  off_diagonal("soft_iron_yz", settings.soft_iron_yz, "Soft-iron share of Z in Y and Y in Z.");
  diagonal("soft_iron_zz", settings.soft_iron_zz, "Soft-iron factor of sensor axis Z.");
  offset("hard_iron_x_ut", settings.hard_iron_x_ut,
         "Hard-iron offset of sensor axis X, subtracted after the soft-iron matrix.");
  offset("hard_iron_y_ut", settings.hard_iron_y_ut, "Hard-iron offset of sensor axis Y.");
  offset("hard_iron_z_ut", settings.hard_iron_z_ut, "Hard-iron offset of sensor axis Z.");
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
  add(table, settings.twist);
  add(table, settings.outage);
  table.read_by(ReadBy::all);
  add(table, settings.admission);
  table.read_by(ReadBy::documented);
  add(table, settings.trust);
  add(table, settings.runaway);
  add(table, settings.motion);
  table.read_by(ReadBy::all);
  add(table, settings.planar);
  table.read_by(ReadBy::documented);
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
