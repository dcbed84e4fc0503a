#include "doctor/probe/beacon_probe.hpp"

#include "doctor/motion/window_fit.hpp"
#include "doctor/probe/rest.hpp"
#include "observation/beacon_observer.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/estimation/documented/delay.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::doctor::probe {

void BeaconProbe::Stream::count(TimeNs received_ns) {
  ++samples;
  longest_ns = std::max(longest_ns, received_ns - last_ns);
  last_ns = received_ns;
}

rules::StreamObservation BeaconProbe::Stream::observation(TimeNs began_ns, TimeNs ended_ns) const {
  const double window_s = seconds_between(began_ns, ended_ns);
  return {.samples = samples,
          .rate_hz = window_s > 0 ? static_cast<double>(samples) / window_s : 0.0,
          .longest_silence_s = static_cast<double>(std::max(longest_ns, ended_ns - last_ns)) * 1e-9};
}

void BeaconProbe::begin(TimeNs now_ns) {
  began_ns_ = now_ns;
  for (Stream* const stream : {&imu_, &fix_, &heading_, &pose_}) stream->last_ns = now_ns;
}

void BeaconProbe::on(const ImuSample& imu, TimeNs received_ns, std::uint64_t writer) {
  if (imu.sequence < last_imu_sequence_) sequences_.clear();  // its bridge restarted
  last_imu_sequence_ = imu.sequence;
  sequences_.add(received_ns, imu.sequence);
  if (!in_window()) return;
  writers_.insert(writer);
  imu_.count(received_ns);
  readings_.add(received_ns, imu);
}

void BeaconProbe::on(const UltrasonicFix& fix, TimeNs received_ns) {
  sequences_.add(received_ns, fix.sequence);
  if (!in_window()) return;
  fix_.count(received_ns);
  fixes_.add(received_ns, fix);
  if (fix.measured_delay_s) ++timed_fixes_;
  if ((fix.flags & ultrasonic_flag_pair_centre) != 0U) ++pair_fixes_;
}

void BeaconProbe::on(const PairHeading& heading, TimeNs received_ns) {
  sequences_.add(received_ns, heading.sequence);
  if (!in_window()) return;
  heading_.count(received_ns);
  if (!heading.valid) return;
  ++valid_headings_;
  headings_.add(received_ns, heading);
}

void BeaconProbe::on(const FusedPose& pose, TimeNs received_ns) {
  if (!in_window()) return;
  pose_.count(received_ns);
  status_counts_.add(pose.status);
}

void BeaconProbe::on(const FixReport& report) {
  if (!in_window()) return;
  ++fix_outcomes_.reports;
  if ((report.flags & fix_outlier) != 0U) fix_outcomes_.outliers_m.push_back(report.innovation_world_m);
}

void BeaconProbe::on(const BeaconStatus& status) {
  if (!status_before_) status_before_ = status;
  status_ = status;
}

void BeaconProbe::on(const FusionStatus& status) {
  const auto [found, is_new] = fusions_.try_emplace(status.fusion_id, FusionObservation{status, status});
  if (!is_new) found->second.latest = status;
}

std::uint64_t BeaconProbe::missing_events(TimeNs ended_ns) const {
  // Samples of different topics arrive in any order, so the last ones may still be in transit.
  constexpr TimeNs in_transit_ns = 200'000'000;
  // For the same reason, some of the oldest may belong to numbers that were dropped.
  TimeNs begin_ns = began_ns_;
  if (sequences_.has_dropped()) {
    begin_ns = std::max(begin_ns, sequences_.entries().front().received_ns + in_transit_ns);
  }
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::set<std::uint64_t> received;
  for (const auto& [received_ns, sequence] : sequences_.entries()) {
    received.insert(sequence);
    if (received_ns < begin_ns || received_ns > ended_ns - in_transit_ns) continue;
    if (first == 0 || sequence < first) first = sequence;
    last = std::max(last, sequence);
  }
  if (first == 0) return 0;
  const auto present = std::distance(received.lower_bound(first), received.upper_bound(last));
  return last - first + 1 - static_cast<std::uint64_t>(present);
}

/// The median.
std::optional<double> BeaconProbe::bridge_ahead_s() const {
  std::vector<double> ahead_s;
  for (const auto& [received_ns, reading] : readings_.entries()) {
    ahead_s.push_back(seconds_between(received_ns, reading.bridge_time_ns));
  }
  if (ahead_s.empty()) return std::nullopt;
  const auto middle = ahead_s.begin() + static_cast<std::ptrdiff_t>(ahead_s.size() / 2);
  std::nth_element(ahead_s.begin(), middle, ahead_s.end());
  return *middle;
}

rules::BeaconObservation BeaconProbe::observation(TimeNs now_ns, const settings::Settings& settings,
                                                  const std::function<bool()>& is_stopped) const {
  rules::BeaconObservation beacon;
  beacon.fusion_settings = settings;
  beacon.pair_fixes = pair_fixes_;
  beacon.fix_outcomes = fix_outcomes_;
  beacon.pieces = motion::pieces_of(motion_window(settings), is_stopped);
  beacon.timed_fixes = timed_fixes_;
  beacon.imu = imu_.observation(began_ns_, now_ns);
  beacon.fix = fix_.observation(began_ns_, now_ns);
  beacon.heading = heading_.observation(began_ns_, now_ns);
  beacon.pose = pose_.observation(began_ns_, now_ns);
  beacon.valid_headings = valid_headings_;
  beacon.events_missing = missing_events(now_ns);
  beacon.bridge_ahead_s = bridge_ahead_s();
  beacon.status_before = status_before_;
  beacon.status = status_;
  for (const auto& entry : fusions_) {
    const FusionObservation& fusion = entry.second;
    beacon.fusions.push_back(fusion.latest);
    if (beacon.fusion && !observation::serves_before(fusion.latest, *beacon.fusion)) continue;
    beacon.fusion_before = fusion.before;
    beacon.fusion = fusion.latest;
  }
  beacon.status_counts = status_counts_;
  beacon.rest = longest_rest(readings_, fixes_, settings.calibration);
  return beacon;
}

/// Samples that are not finite are left out: the fusion does not use them either.
motion::Window BeaconProbe::motion_window(const settings::Settings& settings) const {
  namespace delay = estimation::documented::delay;
  const calibration::Calibration calibration(settings.calibration);
  motion::Window window;
  for (const auto& [received_ns, raw] : readings_.entries()) {
    const ImuSample imu = calibration.corrected(raw);
    if (!imu.angular_velocity_body_radps.allFinite() || !imu.specific_force_body_mps2.allFinite()) continue;
    window.imu.push_back({imu.sensor_time_ns, imu.angular_velocity_body_radps, imu.specific_force_body_mps2});
  }
  for (const auto& [received_ns, fix] : fixes_.entries()) {
    if (!fix.position_world_m.allFinite()) continue;
    window.fixes.push_back({delay::measured_at(settings.delay, fix), fix.position_world_m});
  }
  for (const auto& [received_ns, heading] : headings_.entries()) {
    if (!std::isfinite(heading.heading_world_rad)) continue;
    window.headings.push_back({delay::measured_at(settings.delay, heading), heading.heading_world_rad});
  }
  return window;
}

settings::Settings settings_from(const EffectiveSettings& settings) {
  settings::Settings all;
  for (const auto& [key, value] : settings.values) {
    try {
      settings::set(all, key, settings::parse_value(key, value));
    } catch (const settings::SettingError&) {
      continue;  // a setting of another version
    }
  }
  return all;
}

}  // namespace sonopose::doctor::probe
