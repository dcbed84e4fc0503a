#include "evaluation/replay/strapdown.hpp"

#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/settings/preset.hpp>

#include <limits>
#include <utility>

namespace sonopose::evaluation::strapdown {
namespace {

const Vector3d gravity_world_mps2{0.0, 0.0, -standard_gravity_mps2};

}  // namespace

Integrator::Integrator(const settings::Settings& settings, State start, Rule rule)
    : settings_(settings::resolved(settings)), rule_(rule), state_(std::move(start)) {
  state_.q_body_to_world.normalize();
}

std::optional<FusedPose> Integrator::predict(const ImuSample& imu) {
  const TimeNs last_imu_ns = last_imu_ ? last_imu_->sensor_time_ns : 0;
  if (!estimation::aiding::admission::admits(settings_.admission, last_imu_ns, imu)) {
    ++counters_.samples_invalid;
    return std::nullopt;
  }
  const double silence_s = seconds_between(last_imu_ns, imu.sensor_time_ns);
  if (last_imu_ && silence_s > settings_.outage.imu_gap_s) ++counters_.imu_gaps;
  ++counters_.imu_samples;
  if (state_.time_ns == 0) state_.time_ns = imu.sensor_time_ns;
  integrate(imu);
  last_imu_ = imu;
  if (imu.sensor_time_ns < state_.time_ns) return std::nullopt;
  return pose_at(imu);
}

void Integrator::integrate(const ImuSample& imu) {
  const double dt_s = seconds_between(state_.time_ns, imu.sensor_time_ns);
  if (!(dt_s > 0.0)) return;
  const ImuSample& before = last_imu_ ? *last_imu_ : imu;
  const ImuSample& after = rule_ == Rule::mean ? imu : before;
  const Quaterniond q_before = state_.q_body_to_world;
  const Vector3d rate_body_radps =
      0.5 * (before.angular_velocity_body_radps + after.angular_velocity_body_radps);
  const Quaterniond q_after =
      (q_before * geometry::rotation_by(rate_body_radps * dt_s)).normalized();  // (3), (4)
  const Quaterniond& q_of_after = rule_ == Rule::mean ? q_after : q_before;
  const Vector3d acceleration_world_mps2 =
      0.5 * (q_before * before.specific_force_body_mps2 + q_of_after * after.specific_force_body_mps2) +
      gravity_world_mps2;
  state_.position_world_m +=
      dt_s * state_.velocity_world_mps + 0.5 * dt_s * dt_s * acceleration_world_mps2;  // (1)
  state_.velocity_world_mps += dt_s * acceleration_world_mps2;                         // (2)
  state_.q_body_to_world = q_after;
  state_.time_ns = imu.sensor_time_ns;
}

FusedPose Integrator::pose_at(const ImuSample& imu) const {
  FusedPose pose;
  pose.address = imu.address;
  pose.sequence = imu.sequence;
  pose.time_ns = state_.time_ns;
  pose.position_world_m = state_.position_world_m;
  pose.q_body_to_world = state_.q_body_to_world;
  pose.velocity_world_mps = state_.velocity_world_mps;
  pose.angular_velocity_body_radps = imu.angular_velocity_body_radps;
  pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  pose.imu_sensor_time_ns = imu.sensor_time_ns;
  pose.imu_bridge_time_ns = imu.bridge_time_ns;
  return pose;
}

}  // namespace sonopose::evaluation::strapdown
