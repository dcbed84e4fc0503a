#include "sim/disturbances.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace sonopose::sim {

namespace {

void require(bool good, const std::string& field, double value) {
  if (!good) throw std::invalid_argument("disturbances: " + field + " cannot be " + std::to_string(value));
}

void check_share(const std::string& field, double share) {
  require(share >= 0 && share <= 1, field, share);
}

void check_time(const std::string& field, double time_s) {
  require(std::isfinite(time_s) && time_s >= 0, field, time_s);
}

void check_vector(const std::string& field, const Vector3d& value) {
  for (const double x : value) require(std::isfinite(x), field, x);
}

void check_range(const std::string& field, const Range& range) {
  check_time(field, range.min);
  check_time(field, range.max - range.min);
}

void check_wall(const std::string& field, const Wall& wall) {
  check_vector(field + ".point_world_m", wall.point_world_m);
  const double norm = wall.normal_world.norm();
  require(std::abs(norm - 1.0) < 1e-9, field + ".normal_world: its length", norm);
  require(wall.normal_world.z() == 0.0, field + ".normal_world.z", wall.normal_world.z());
}

void check_beacons(const MisplacedBeacon& map) {
  constexpr std::size_t min_beacons = 3;
  require(map.beacons_world_m.size() >= min_beacons, "misplaced_beacon.beacons_world_m: their number",
          static_cast<double>(map.beacons_world_m.size()));
  require(map.misplaced < map.beacons_world_m.size(), "misplaced_beacon.misplaced",
          static_cast<double>(map.misplaced));
  for (const Vector3d& beacon : map.beacons_world_m) check_vector("misplaced_beacon.beacons_world_m", beacon);
  check_vector("misplaced_beacon.map_error_m", map.map_error_m);
}

/// Displacement of a fix, to first order in the error of the map.
Vector3d misplacement_world_m(const MisplacedBeacon& map, const Vector3d& position_world_m) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (std::size_t i = 0; i < map.beacons_world_m.size(); ++i) {
    const Vector3d direction = (position_world_m - map.beacons_world_m[i]).normalized();
    normal += direction * direction.transpose();
    if (i == map.misplaced) right = direction * direction.dot(map.map_error_m);
  }
  return normal.ldlt().solve(right);
}

void check_packets(const std::string& field, const PacketFaults& faults) {
  check_share(field + ".dropped_share", faults.dropped_share);
  check_share(field + ".lost_runs_share", faults.lost_runs_share);
  check_share(field + ".duplicated_share", faults.duplicated_share);
  check_share(field + ".late_share", faults.late_share);
  check_share(field + ": the sum of the shares",
              faults.dropped_share + faults.lost_runs_share + faults.duplicated_share + faults.late_share);
  check_range(field + ".late_by_s", faults.late_by_s);
}

/// Anything with a begin and a duration.
template <typename Span>
void check_spans(const std::string& field, const std::vector<Span>& spans) {
  for (const Span& span : spans) {
    check_time(field + ".begin_s", span.begin_s);
    check_time(field + ".duration_s", span.duration_s);
  }
}

template <typename Span>
bool holds(const Span& span, double time_s) {
  return time_s >= span.begin_s && time_s < span.begin_s + span.duration_s;
}

template <typename Span>
bool any_holds(const std::vector<Span>& spans, double time_s) {
  return std::any_of(spans.begin(), spans.end(), [time_s](const Span& span) { return holds(span, time_s); });
}

}  // namespace

void check(const Disturbances& disturbances) {
  check_spans("outages", disturbances.outages);
  check_spans("imu_outages", disturbances.imu_outages);
  check_spans("halved_fix_rates", disturbances.halved_fix_rates);
  check_spans("wheel_slips", disturbances.wheel_slips);
  check_spans("outlier_bursts", disturbances.outlier_bursts);
  for (const OutlierBurst& burst : disturbances.outlier_bursts) {
    check_vector("outlier_bursts.offset_world_m", burst.offset_world_m);
    check_vector("outlier_bursts.drift_world_mps", burst.drift_world_mps);
    if (burst.mirror) check_wall("outlier_bursts.mirror", *burst.mirror);
  }
  for (const Relocation& relocation : disturbances.relocations) {
    check_time("relocations.at_s", relocation.at_s);
    check_vector("relocations.by_world_m", relocation.by_world_m);
    require(std::isfinite(relocation.turn_rad), "relocations.turn_rad", relocation.turn_rad);
    check_vector("relocations.pivot_world_m", relocation.pivot_world_m);
  }
  check_spans("heading_errors", disturbances.heading_errors);
  for (const HeadingError& error : disturbances.heading_errors) {
    require(std::isfinite(error.peak_rad), "heading_errors.peak_rad", error.peak_rad);
  }
  check_spans("fix_faults", disturbances.fix_faults);
  for (const FixFault& fault : disturbances.fix_faults) check_time("fix_faults.noise_m", fault.noise_m);
  if (const auto& drift = disturbances.gyro_drift) {
    check_time("gyro_drift.begin_s", drift->begin_s);
    check_time("gyro_drift.duration_s", drift->duration_s);
    check_vector("gyro_drift.by_body_radps", drift->by_body_radps);
  }
  check_spans("imu_faults", disturbances.imu_faults);
  for (const ImuFault& fault : disturbances.imu_faults) {
    check_vector("imu_faults.accel_offset_body_mps2", fault.accel_offset_body_mps2);
    check_vector("imu_faults.gyro_offset_body_radps", fault.gyro_offset_body_radps);
    check_vector("imu_faults.accel_factor", fault.accel_factor);
    check_vector("imu_faults.gyro_factor", fault.gyro_factor);
    check_vector("imu_faults.turned_by_rad", fault.turned_by_rad);
    check_time("imu_faults.vibration_mps2", fault.vibration_mps2);
    check_time("imu_faults.vibration_radps", fault.vibration_radps);
  }
  if (const auto& field = disturbances.bias_field) {
    check_vector("bias_field.amplitude_world_m", field->amplitude_world_m);
    check_vector("bias_field.wave_radpm", field->wave_radpm);
    require(std::isfinite(field->phase_rad), "bias_field.phase_rad", field->phase_rad);
  }
  if (disturbances.misplaced_beacon) check_beacons(*disturbances.misplaced_beacon);
  double poor_share = 0;
  for (const PoorFixes& kind : disturbances.poor_fixes) {
    check_share("poor_fixes.share", kind.share);
    poor_share += kind.share;
    check_time("poor_fixes.noise_factor", kind.noise_factor);
    const Range quality_percent = kind.quality_percent.value_or(Range{});
    for (const double percent : {quality_percent.min, quality_percent.max}) {
      require(percent >= 0 && percent <= 100, "poor_fixes.quality_percent", percent);
    }
    check_range("poor_fixes.offset_m", kind.offset_m);
    check_vector("poor_fixes.default_world_m", kind.default_world_m.value_or(Vector3d::Zero()));
  }
  check_share("poor_fixes: the sum of the shares", poor_share);
  check_packets("imu_packets", disturbances.imu_packets);
  check_packets("position_packets", disturbances.position_packets);
}

bool is_outage(const std::vector<Outage>& outages, double time_s) {
  return any_holds(outages, time_s);
}

bool is_left_out(const Disturbances& disturbances, double time_s, std::uint64_t emission) {
  return emission % 2 == 1 && any_holds(disturbances.halved_fix_rates, time_s);
}

void apply_imu_faults(const Disturbances& disturbances, double time_s, Random& random, ImuSample& sample) {
  for (const ImuFault& fault : disturbances.imu_faults) {
    if (!holds(fault, time_s)) continue;
    if (!fault.turned_by_rad.isZero()) {
      const Quaterniond q_body_to_imu = geometry::rotation_by(fault.turned_by_rad).conjugate();
      sample.specific_force_body_mps2 = q_body_to_imu * sample.specific_force_body_mps2;
      sample.angular_velocity_body_radps = q_body_to_imu * sample.angular_velocity_body_radps;
    }
    sample.specific_force_body_mps2 =
        fault.accel_factor.cwiseProduct(sample.specific_force_body_mps2) + fault.accel_offset_body_mps2;
    sample.angular_velocity_body_radps =
        fault.gyro_factor.cwiseProduct(sample.angular_velocity_body_radps) + fault.gyro_offset_body_radps;
    if (fault.vibration_mps2 > 0.0) {
      sample.specific_force_body_mps2 += fault.vibration_mps2 * random.normal_vector();
    }
    if (fault.vibration_radps > 0.0) {
      sample.angular_velocity_body_radps += fault.vibration_radps * random.normal_vector();
    }
  }
}

Vector3d track_offset_world_m(const Disturbances& disturbances, double time_s,
                              const Vector3d& position_world_m) {
  Vector3d offset_world_m = Vector3d::Zero();
  for (const OutlierBurst& burst : disturbances.outlier_bursts) {
    if (!holds(burst, time_s)) continue;
    offset_world_m += burst.offset_world_m + (time_s - burst.begin_s) * burst.drift_world_mps;
    if (burst.mirror) {
      const Vector3d& normal = burst.mirror->normal_world;
      offset_world_m += 2.0 * normal.dot(burst.mirror->point_world_m - position_world_m) * normal;
    }
  }
  if (const auto& field = disturbances.bias_field) {
    offset_world_m +=
        std::sin(field->wave_radpm.dot(position_world_m) + field->phase_rad) * field->amplitude_world_m;
  }
  if (const auto& map = disturbances.misplaced_beacon) {
    offset_world_m += misplacement_world_m(*map, position_world_m);
  }
  return offset_world_m;
}

Motion relocated(const Disturbances& disturbances, double time_s, const Motion& motion) {
  Motion result = motion;
  for (const Relocation& relocation : disturbances.relocations) {
    if (time_s < relocation.at_s) continue;
    if (relocation.turn_rad != 0.0) result = turned(result, relocation.pivot_world_m, relocation.turn_rad);
    result.position_world_m += relocation.by_world_m;
  }
  return result;
}

double wheel_slip(const Disturbances& disturbances, double time_s) {
  double by = 0;
  for (const WheelSlip& slip : disturbances.wheel_slips) {
    if (holds(slip, time_s)) by += slip.by;
  }
  return by;
}

double heading_error_rad(const Disturbances& disturbances, double time_s) {
  double error_rad = 0;
  for (const HeadingError& error : disturbances.heading_errors) {
    if (!holds(error, time_s)) continue;
    const double rise =
        error.is_step ? 1.0 : std::sin(std::numbers::pi * (time_s - error.begin_s) / error.duration_s);
    error_rad += error.peak_rad * rise * rise;
  }
  return error_rad;
}

Vector3d gyro_drift_body_radps(const Disturbances& disturbances, double time_s) {
  const auto& drift = disturbances.gyro_drift;
  if (!drift || time_s <= drift->begin_s) return Vector3d::Zero();
  if (time_s >= drift->begin_s + drift->duration_s) return drift->by_body_radps;
  return (time_s - drift->begin_s) / drift->duration_s * drift->by_body_radps;
}

Vector3d draw_fault_noise_world_m(const Disturbances& disturbances, double time_s, Random& random) {
  Vector3d noise_m = Vector3d::Zero();
  for (const FixFault& fault : disturbances.fix_faults) {
    if (holds(fault, time_s) && fault.noise_m > 0.0) noise_m += fault.noise_m * random.normal_vector();
  }
  return noise_m;
}

bool repeats_position(const Disturbances& disturbances, double time_s) {
  return std::any_of(disturbances.fix_faults.begin(), disturbances.fix_faults.end(),
                     [time_s](const FixFault& fault) { return fault.repeats && holds(fault, time_s); });
}

const PoorFixes* draw_poor_fix(const Disturbances& disturbances, Random& random) {
  double left = random.uniform();
  for (const PoorFixes& kind : disturbances.poor_fixes) {
    if (left < kind.share) return &kind;
    left -= kind.share;
  }
  return nullptr;
}

Vector3d draw_offset_world_m(const PoorFixes& kind, Random& random) {
  if (kind.offset_m.max == 0.0) return Vector3d::Zero();
  const double distance_m = random.uniform_in(kind.offset_m);
  return distance_m * random.direction();
}

std::vector<PoorFixes> poor_reception() {
  return {{.share = 0.25, .quality_percent = Range{10.0, 48.0}, .noise_factor = 12.0},
          {.share = 0.20, .quality_percent = Range{55.0, 75.0}, .noise_factor = 2.0}};
}

PacketChannel::PacketChannel(const PacketFaults& faults, Random random) : faults_{faults}, random_{random} {}

PacketFate PacketChannel::next() {
  if (still_to_lose_ > 0) {
    --still_to_lose_;
    return {.copies = 0};
  }
  double left = random_.uniform();
  const auto is = [&left](double share) { return std::exchange(left, left - share) < share; };
  // `left` is reduced by the shares before this one.
  if (is(faults_.dropped_share)) return {.copies = 0};
  if (is(faults_.lost_runs_share)) {
    still_to_lose_ = 2 + static_cast<int>(4.0 * random_.uniform());
    return {.copies = 0};
  }
  if (is(faults_.duplicated_share)) return {.copies = 2};
  if (is(faults_.late_share)) return {.copies = 1, .late_s = random_.uniform_in(faults_.late_by_s)};
  return {};
}

}  // namespace sonopose::sim
