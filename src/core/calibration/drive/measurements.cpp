#include "calibration/drive/measurements.hpp"

#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/estimation/offline/judgement.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::calibration::drive::detail {
namespace {

template <class Measurement>
void sort_by_time(std::vector<Measurement>& all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Measurement& a, const Measurement& b) { return a.time_ns < b.time_ns; });
  const auto repeated = [](const Measurement& a, const Measurement& b) { return a.time_ns == b.time_ns; };
  all.erase(std::unique(all.begin(), all.end(), repeated), all.end());
}

/// Removes what a sensor with noise repeats: a silence is left.
void remove_repetitions(std::vector<ImuMeasurement>& imu) {
  estimation::kalman::RepeatDetector repeats;
  ImuMeasurement last;
  std::erase_if(imu, [&](const ImuMeasurement& sample) {
    const bool is_repetition = repeats.repeats_with(last, sample);
    repeats.add(last, sample);
    last = sample;
    return is_repetition;
  });
}

}  // namespace

Measurements measurements_of(std::span<const Event> events, const settings::Settings& settings) {
  const Calibration calibration(settings.calibration);
  Measurements log;
  for (const Event& event : events) {
    if (const auto* raw = std::get_if<ImuSample>(&event)) {
      const ImuSample imu = calibration.corrected(*raw);
      if (!imu.angular_velocity_body_radps.allFinite() || !imu.specific_force_body_mps2.allFinite()) continue;
      log.imu.push_back(estimation::kalman::as_measurement(imu));
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      if (!fix->position_world_m.allFinite() || (fix->flags & ultrasonic_flag_set_pose) != 0) continue;
      log.fixes.push_back({fix->emission_time_ns, fix->position_world_m, fix->sequence});
    } else if (const auto* heading = std::get_if<PairHeading>(&event);
               heading != nullptr && heading->valid && (heading->flags & heading_flag_of_body) == 0 &&
               std::isfinite(heading->heading_world_rad)) {
      log.headings.push_back({heading->emission_time_ns, heading->heading_world_rad, heading->sequence});
    }
  }
  sort_by_time(log.imu);
  sort_by_time(log.fixes);
  sort_by_time(log.headings);
  remove_repetitions(log.imu);
  return log;
}

std::set<std::uint64_t> used_by_engine(std::span<const Event> events, const settings::Settings& settings,
                                       double mount_rad, double delay_s) {
  settings::Settings known = settings;
  known.heading.mount_offset_deg = geometry::wrap_angle(mount_rad) / geometry::radians_per_degree;
  known.delay.extrapolate = true;
  known.delay.source = settings::DelaySource::measured;
  known.delay.correction_s = delay_s;
  known.delay.estimate = false;
  std::set<std::uint64_t> used;
  for (const auto& segment : estimation::offline::judged(known, events)) {
    for (const auto& fix : segment.fixes) {
      if (fix.used) used.insert(fix.sequence);
    }
    for (const auto& heading : segment.headings) {
      if (heading.used) used.insert(heading.sequence);
    }
  }
  return used;
}

std::vector<Event> set_back(std::vector<Event> events, double delay_s) {
  const auto set_sample_back = [delay_s](auto* sample) {
    if (sample == nullptr) return;
    sample->emission_time_ns = saturated_sum(sample->emission_time_ns, -to_ns(delay_s));
    sample->received_time_ns =
        std::max(saturated_sum(sample->received_time_ns, -to_ns(delay_s)), sample->emission_time_ns);
  };
  for (Event& event : events) {
    set_sample_back(std::get_if<UltrasonicFix>(&event));
    set_sample_back(std::get_if<PairHeading>(&event));
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return available_at_ns(a) < available_at_ns(b); });
  return events;
}

double scatter_rthz(const std::vector<Measurements>& logs, Vector3d ImuMeasurement::*sensor) {
  double largest = 0;
  for (const Measurements& log : logs) {
    Vector3d squares = Vector3d::Zero();
    for (std::size_t i = 1; i < log.imu.size(); ++i) {
      squares += (log.imu[i].*sensor - log.imu[i - 1].*sensor).cwiseAbs2();
    }
    // The difference of two samples has twice the variance of one; the density is σ² times the interval.
    const auto samples = static_cast<double>(log.imu.size());
    const double interval_s = seconds_between(log.imu.front().time_ns, log.imu.back().time_ns) / samples;
    largest = std::max(largest, std::sqrt(squares.maxCoeff() / (2.0 * samples) * interval_s));
  }
  return largest;
}

double rms_speed_mps(const std::vector<Measurements>& logs) {
  constexpr double span_s = 0.5;
  double squares = 0;
  double duration_s = 0;
  for (const Measurements& log : logs) {
    const Fix* from = nullptr;
    for (const Fix& fix : log.fixes) {
      if (!fix.used) continue;
      const double since_s = from == nullptr ? 0.0 : seconds_between(from->time_ns, fix.time_ns);
      if (from != nullptr && since_s < span_s) continue;
      if (from != nullptr) {
        squares += (fix.position_world_m - from->position_world_m).squaredNorm() / since_s;
        duration_s += since_s;
      }
      from = &fix;
    }
  }
  return duration_s > 0.0 ? std::sqrt(squares / duration_s) : 0.0;
}

}  // namespace sonopose::calibration::drive::detail
