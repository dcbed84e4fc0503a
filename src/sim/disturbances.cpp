#include "sim/disturbances.hpp"

#include <algorithm>
#include <cmath>
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

void check_packets(const std::string& field, const PacketFaults& faults) {
  check_share(field + ".dropped_share", faults.dropped_share);
  check_share(field + ".lost_runs_share", faults.lost_runs_share);
  check_share(field + ".duplicated_share", faults.duplicated_share);
  check_share(field + ".late_share", faults.late_share);
  check_share(field + ": the sum of the shares",
              faults.dropped_share + faults.lost_runs_share + faults.duplicated_share + faults.late_share);
  check_time(field + ".late_by_s", faults.late_by_s.least);
  check_time(field + ".late_by_s", faults.late_by_s.most - faults.late_by_s.least);
}

template <typename Span>
bool holds(const Span& span, double time_s) {
  return time_s >= span.begin_s && time_s < span.begin_s + span.duration_s;
}

}  // namespace

void check(const Disturbances& disturbances) {
  for (const Outage& outage : disturbances.outages) {
    check_time("outages.begin_s", outage.begin_s);
    check_time("outages.duration_s", outage.duration_s);
  }
  for (const OutlierBurst& burst : disturbances.outlier_bursts) {
    check_time("outlier_bursts.begin_s", burst.begin_s);
    check_time("outlier_bursts.duration_s", burst.duration_s);
    check_vector("outlier_bursts.offset_world_m", burst.offset_world_m);
  }
  for (const Relocation& relocation : disturbances.relocations) {
    check_time("relocations.at_s", relocation.at_s);
    check_vector("relocations.by_world_m", relocation.by_world_m);
  }
  if (const auto& drift = disturbances.gyro_drift) {
    check_time("gyro_drift.begin_s", drift->begin_s);
    check_time("gyro_drift.duration_s", drift->duration_s);
    check_vector("gyro_drift.by_body_radps", drift->by_body_radps);
  }
  double poor_share = 0;
  for (const PoorFixes& kind : disturbances.poor_fixes) {
    check_share("poor_fixes.share", kind.share);
    poor_share += kind.share;
    check_time("poor_fixes.noise_factor", kind.noise_factor);
    for (const double percent : {kind.quality_percent.least, kind.quality_percent.most}) {
      require(percent >= 0 && percent <= 100, "poor_fixes.quality_percent", percent);
    }
  }
  check_share("poor_fixes: the sum of the shares", poor_share);
  check_packets("imu_packets", disturbances.imu_packets);
  check_packets("position_packets", disturbances.position_packets);
}

bool is_outage(const Disturbances& disturbances, double time_s) {
  return std::any_of(disturbances.outages.begin(), disturbances.outages.end(),
                     [time_s](const Outage& outage) { return holds(outage, time_s); });
}

Vector3d track_offset_world_m(const Disturbances& disturbances, double time_s) {
  Vector3d offset_world_m = Vector3d::Zero();
  for (const OutlierBurst& burst : disturbances.outlier_bursts) {
    if (holds(burst, time_s)) offset_world_m += burst.offset_world_m;
  }
  return offset_world_m;
}

Vector3d relocated_by_world_m(const Disturbances& disturbances, double time_s) {
  Vector3d by_world_m = Vector3d::Zero();
  for (const Relocation& relocation : disturbances.relocations) {
    if (time_s >= relocation.at_s) by_world_m += relocation.by_world_m;
  }
  return by_world_m;
}

Vector3d gyro_drift_body_radps(const Disturbances& disturbances, double time_s) {
  const auto& drift = disturbances.gyro_drift;
  if (!drift || time_s <= drift->begin_s) return Vector3d::Zero();
  if (time_s >= drift->begin_s + drift->duration_s) return drift->by_body_radps;
  return (time_s - drift->begin_s) / drift->duration_s * drift->by_body_radps;
}

const PoorFixes* draw_poor_fix(const Disturbances& disturbances, Random& random) {
  double left = random.uniform();
  for (const PoorFixes& kind : disturbances.poor_fixes) {
    if (left < kind.share) return &kind;
    left -= kind.share;
  }
  return nullptr;
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
