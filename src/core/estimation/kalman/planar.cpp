// A body that stays in a horizontal plane: height, roll, pitch and vertical speed as pseudo-measurements.

#include "estimation/kalman/state_internal.hpp"
#include <sonopose/geometry/cross_matrix.hpp>

#include <cmath>

namespace sonopose::estimation::kalman {
namespace {

/// Corrects a filter by a linear function of its state that stays within `std` of its value for ever. Its
/// error is always the same, so that it lowers the variance to that of `std` and no further.
void hold(Filter& filter, const StateVector& h, double innovation, double std) {
  VelocityInnovation measured{.value_mps = innovation};
  measured.column.noalias() = filter.covariance * h;
  const double known = h.dot(measured.column);
  const double held = square(std);
  if (!(known > held)) return;
  measured.variance_m2ps2 = known + known * held / (known - held);
  if (filter.estimates_delay()) measured.delay_row = h.dot(filter.delay_covariance);
  if (filter.scale) measured.scale_row = h.dot(filter.scale->covariance);
  filter.correct_velocity(measured, 0.0);
}

void hold_tilt(Filter& filter, double std_rad) {
  for (int axis = 0; axis < 2; ++axis) {
    const Vector3d up_body = geometry::up_in_body(filter.q_body_to_world);
    StateVector h = StateVector::Zero();
    h.segment<3>(at_attitude) = geometry::cross_matrix(up_body).row(axis).transpose();
    hold(filter, h, -up_body[axis], std_rad);
  }
}

void hold_vertical_speed(Filter& filter, double tilt_std_rad) {
  constexpr double min_std_mps = 0.01;
  const double slope_mps = std::tan(tilt_std_rad) * filter.velocity_world_mps.head<2>().norm();
  StateVector h = StateVector::Zero();
  h[at_velocity + 2] = 1.0;
  hold(filter, h, -filter.velocity_world_mps.z(), min_std_mps + slope_mps);
}

}  // namespace

void hold_plane(State& state, const settings::PlanarSettings& settings, TimeNs before_ns) {
  constexpr TimeNs period_ns = 97'500'000;  // no multiple of a usual sample interval
  const TimeNs now_ns = state.imu.time_ns;
  if (!settings.planar || state.phase == Phase::waiting || before_ns / period_ns == now_ns / period_ns)
    return;
  state.propagate();
  const double tilt_std_rad = radians(settings.tilt_std_deg);
  for (Hypothesis& each : state.bank) {
    Filter& filter = each.filter;
    hold_tilt(filter, tilt_std_rad);
    hold_vertical_speed(filter, tilt_std_rad);
    if (settings.height_from != settings::HeightSource::setting) continue;
    hold(filter, filter.fix_jacobian(0.0).row(2).transpose(),
         settings.height_m - filter.tracked_position_world_m().z(), settings.height_std_m);
  }
}

}  // namespace sonopose::estimation::kalman
