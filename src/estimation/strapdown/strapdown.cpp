#include <sonopose/estimation/strapdown/strapdown.hpp>
#include <sonopose/geometry/rotation.hpp>

namespace sonopose::estimation {
namespace {

const Vector3d gravity_world_mps2{0.0, 0.0, -standard_gravity_mps2};

}  // namespace

Strapdown::Strapdown(const StrapdownState& start, StrapdownRule rule) : state_(start), rule_(rule) {
  state_.q_body_to_world.normalize();
}

void Strapdown::on(const ImuSample& imu) {
  const double dt_s = seconds_between(state_.time_ns, imu.sensor_time_ns);
  if (dt_s > 0.0) {
    const ImuSample& before = previous_ ? *previous_ : imu;
    const ImuSample& after = rule_ == StrapdownRule::mean ? imu : before;
    const Quaterniond q_before = state_.q_body_to_world;
    const Vector3d rate_body_radps =
        0.5 * (before.angular_velocity_body_radps + after.angular_velocity_body_radps);
    const Quaterniond q_after =
        (q_before * geometry::rotation_by(rate_body_radps * dt_s)).normalized();  // (3), (4)
    const Quaterniond& q_of_after = rule_ == StrapdownRule::mean ? q_after : q_before;
    const Vector3d acceleration_world_mps2 =
        0.5 * (q_before * before.specific_force_body_mps2 + q_of_after * after.specific_force_body_mps2) +
        gravity_world_mps2;
    state_.position_world_m +=
        dt_s * state_.velocity_world_mps + 0.5 * dt_s * dt_s * acceleration_world_mps2;  // (1)
    state_.velocity_world_mps += dt_s * acceleration_world_mps2;                         // (2)
    state_.q_body_to_world = q_after;
    state_.time_ns = imu.sensor_time_ns;
  }
  previous_ = imu;
}

}  // namespace sonopose::estimation
