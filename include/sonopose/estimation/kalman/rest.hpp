#pragma once
/// \file
/// Detection of rest from the spread of the IMU over windows of half a second.

#include <sonopose/samples/field_fault.hpp>
#include <sonopose/samples/samples.hpp>

namespace sonopose::estimation::kalman {

/// Regression of up to three values over time, with forgetting.
struct Trend {
  int samples = 0;
  TimeNs latest_ns = 0;
  double weight = 0;
  double time_mean_s = 0;  ///< relative to `latest_ns`, like the products
  double time_squares_s2 = 0;
  Vector3d mean = Vector3d::Zero();
  Vector3d products = Vector3d::Zero();

  void add(TimeNs time_ns, const Vector3d& value);
  [[nodiscard]] bool operator==(const Trend&) const = default;
};

struct RestState {
  TimeNs window_began_ns = 0;
  int samples = 0;
  Vector3d gyro_mean = Vector3d::Zero();
  Vector3d gyro_squares = Vector3d::Zero();  ///< Welford's sum of squared deviations
  Vector3d accel_mean = Vector3d::Zero();
  Vector3d accel_squares = Vector3d::Zero();
  int still_windows = 0;                        ///< number of consecutive still windows
  TimeNs still_since_ns = 0;                    ///< start of the first of these windows
  Vector3d still_gyro_mean = Vector3d::Zero();  ///< mean of the latest still window
  Vector3d still_accel_mean = Vector3d::Zero();
  Trend fixes;     ///< trend of the position since then, m
  Trend headings;  ///< trend since then; X is the heading relative to the first one, rad
  double first_heading_rad = 0;

  bool operator==(const RestState&) const = default;
};

namespace rest {

/// Adds a sample. Returns true if it completes a window: then call `end_window`.
[[nodiscard]] bool add_sample(RestState& state, TimeNs time_ns, const Vector3d& rate_body_radps,
                              const Vector3d& force_body_mps2);

/// Begins the next window. Returns true if the last one was still. Its mean rate and force are then those of
/// rest, unless the body cruises smoothly.
bool end_window(RestState& state, TimeNs time_ns, const Vector3d& gyro_bias_body_radps,
                double bias_std_radps);

/// Adds a fix that was used.
void add_fix(RestState& state, TimeNs time_ns, const Vector3d& position_world_m);

/// Adds a heading, used or not.
void add_heading(RestState& state, TimeNs time_ns, double heading_rad);

/// Ends the rest after a gap in the samples.
void restart(RestState& state);

/// True if the body rests and the latest fixes since then, at least `min_fixes`, agree with that.
[[nodiscard]] bool fixes_stand_still(const RestState& state, const Vector3d& fix_std_m, int min_fixes);

/// Variance (rad/s)² of the mean rate over the half second of rest that ends now, as a measurement of the
/// gyro bias.
[[nodiscard]] double still_rate_variance(const RestState& state, TimeNs now_ns);

/// Variance (m/s)² of zero velocity as a measurement at this moment of a rest.
[[nodiscard]] double still_velocity_variance(const RestState& state, TimeNs now_ns);

/// True if the latest headings since the rest began contradict a body that does not turn.
[[nodiscard]] bool headings_turn(const RestState& state, double heading_std_rad);

}  // namespace rest
void for_each_field(IsFieldsOf<Trend> auto& trend, const auto& visit) {
  visit("samples", trend.samples);
  visit("latest_ns", trend.latest_ns);
  visit("weight", trend.weight);
  visit("time_mean_s", trend.time_mean_s);
  visit("time_squares_s2", trend.time_squares_s2);
  visit("mean", trend.mean);
  visit("products", trend.products);
}

void for_each_field(IsFieldsOf<RestState> auto& rest, const auto& visit) {
  visit("window_began_ns", rest.window_began_ns);
  visit("samples", rest.samples);
  visit("gyro_mean", rest.gyro_mean);
  visit("gyro_squares", rest.gyro_squares);
  visit("accel_mean", rest.accel_mean);
  visit("accel_squares", rest.accel_squares);
  visit("still_windows", rest.still_windows);
  visit("still_since_ns", rest.still_since_ns);
  visit("still_gyro_mean", rest.still_gyro_mean);
  visit("still_accel_mean", rest.still_accel_mean);
  visit("fixes", rest.fixes);
  visit("headings", rest.headings);
  visit("first_heading_rad", rest.first_heading_rad);
}

}  // namespace sonopose::estimation::kalman
