#include <sonopose/estimation/aiding/admission.hpp>
#include <sonopose/estimation/strapdown/engine.hpp>
#include <sonopose/geometry/rotation.hpp>
#include <sonopose/samples/outputs.hpp>
#include <sonopose/settings/preset.hpp>

#include <limits>

namespace sonopose::estimation::strapdown {
namespace {

const Vector3d gravity_world_mps2{0.0, 0.0, -standard_gravity_mps2};

State normalised(State state) {
  state.q_body_to_world.normalize();
  return state;
}

FusedPose pose_at(const ImuSample& imu, const Snapshot& now) {
  FusedPose pose;
  pose.address = imu.address;
  pose.sequence = imu.sequence;
  pose.time_ns = now.state.time_ns;
  pose.position_world_m = now.state.position_world_m;
  pose.q_body_to_world = now.state.q_body_to_world;
  pose.velocity_world_mps = now.state.velocity_world_mps;
  pose.angular_velocity_body_radps = imu.angular_velocity_body_radps;
  pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  pose.reset_counter = now.reset_counter;
  pose.imu_sensor_time_ns = imu.sensor_time_ns;
  pose.imu_bridge_time_ns = imu.bridge_time_ns;
  return pose;
}

}  // namespace

Engine::Engine(const settings::Settings& settings, const State& start, Rule rule)
    : settings_(settings::resolved(settings)) {
  now_.start = normalised(start);
  now_.rule = rule;
  now_.state = now_.start;
}

void Engine::configure(const settings::Settings& settings) noexcept {
  settings_ = settings::resolved(settings);
}

void Engine::reset() noexcept {
  now_ = {.start = now_.start,
          .rule = now_.rule,
          .state = now_.start,
          .counters = now_.counters,
          .reset_counter = now_.reset_counter + 1};
}

std::optional<FusedPose> Engine::predict(const ImuSample& imu) noexcept {
  if (!aiding::admission::admits(settings_.admission, now_.last_imu_ns, imu)) {
    ++now_.counters.samples_invalid;
    return std::nullopt;
  }
  const double silence_s = seconds_between(now_.last_imu_ns, imu.sensor_time_ns);
  if (now_.last_imu_ns != 0 && silence_s > settings_.outage.imu_gap_s) ++now_.counters.imu_gaps;
  now_.last_imu_ns = imu.sensor_time_ns;
  ++now_.counters.imu_samples;
  if (now_.state.time_ns == 0) now_.state.time_ns = imu.sensor_time_ns;
  integrate(imu);
  now_.has_previous = true;
  now_.previous_angular_velocity_body_radps = imu.angular_velocity_body_radps;
  now_.previous_specific_force_body_mps2 = imu.specific_force_body_mps2;
  if (imu.sensor_time_ns < now_.state.time_ns) return std::nullopt;
  return pose_at(imu, now_);
}

void Engine::integrate(const ImuSample& imu) {
  State& state = now_.state;
  const double dt_s = seconds_between(state.time_ns, imu.sensor_time_ns);
  if (!(dt_s > 0.0)) return;
  const Vector3d& rate = imu.angular_velocity_body_radps;
  const Vector3d& force = imu.specific_force_body_mps2;
  const Vector3d rate_before = now_.has_previous ? now_.previous_angular_velocity_body_radps : rate;
  const Vector3d force_before = now_.has_previous ? now_.previous_specific_force_body_mps2 : force;
  const bool by_mean = now_.rule == Rule::mean;
  const Vector3d& rate_after = by_mean ? rate : rate_before;
  const Vector3d& force_after = by_mean ? force : force_before;

  const Quaterniond q_before = state.q_body_to_world;
  const Vector3d rate_body_radps = 0.5 * (rate_before + rate_after);
  const Quaterniond q_after =
      (q_before * geometry::rotation_by(rate_body_radps * dt_s)).normalized();  // (3), (4)
  const Quaterniond& q_of_after = by_mean ? q_after : q_before;
  const Vector3d acceleration_world_mps2 =
      0.5 * (q_before * force_before + q_of_after * force_after) + gravity_world_mps2;
  state.position_world_m +=
      dt_s * state.velocity_world_mps + 0.5 * dt_s * dt_s * acceleration_world_mps2;  // (1)
  state.velocity_world_mps += dt_s * acceleration_world_mps2;                         // (2)
  state.q_body_to_world = q_after;
  state.time_ns = imu.sensor_time_ns;
}

Estimate Engine::estimate() const {
  Estimate estimate;
  estimate.time_ns = now_.last_imu_ns;
  return estimate;
}

FixReport Engine::correct(const UltrasonicFix& fix) noexcept {
  FixReport report = report_on(fix, now_.state.time_ns);
  report.shifted_position_world_m = fix.position_world_m;
  return report;
}

}  // namespace sonopose::estimation::strapdown
