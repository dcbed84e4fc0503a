#include "doctor/probe/beacon_probe.hpp"

#include "observation/beacon_view.hpp"
#include <sonopose/calibration/model/calibration.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <algorithm>
#include <cmath>

namespace sonopose::doctor {

void BeaconProbe::Stream::count(TimeNs received_ns) {
  ++samples;
  longest_ns = std::max(longest_ns, received_ns - last_ns);
  last_ns = received_ns;
}

StreamObservation BeaconProbe::Stream::seen(TimeNs began_ns, TimeNs ended_ns) const {
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
  if (imu.sequence < last_imu_number_) numbers_.clear();  // its bridge began anew
  last_imu_number_ = imu.sequence;
  number(imu.sequence, received_ns);
  if (!in_window()) return;
  writers_.insert(writer);
  imu_.count(received_ns);
  ahead_s_.push_back(seconds_between(received_ns, imu.bridge_time_ns));
  readings_.emplace_back(imu.specific_force_body_mps2, imu.angular_velocity_body_radps);
}

void BeaconProbe::on(const UltrasonicFix& fix, TimeNs received_ns) {
  number(fix.sequence, received_ns);
  if (!in_window()) return;
  fix_.count(received_ns);
  fixes_min_m_ = fixes_min_m_.cwiseMin(fix.position_world_m);
  fixes_max_m_ = fixes_max_m_.cwiseMax(fix.position_world_m);
}

void BeaconProbe::on(const PairHeading& heading, TimeNs received_ns) {
  number(heading.sequence, received_ns);
  if (!in_window()) return;
  heading_.count(received_ns);
  if (heading.valid) ++valid_headings_;
}

void BeaconProbe::on(const FusedPose& pose, TimeNs received_ns) {
  if (!in_window()) return;
  pose_.count(received_ns);
  lasting_status_ &= pose.status;
}

void BeaconProbe::on(const BeaconStatus& status) {
  if (!status_before_) status_before_ = status;
  status_ = status;
}

void BeaconProbe::on(const FusionStatus& status) {
  const auto [found, is_new] = fusions_.try_emplace(status.fusion_id, FusionObservation{status, status});
  if (!is_new) found->second.latest = status;
}

void BeaconProbe::number(std::uint64_t sequence, TimeNs received_ns) {
  numbers_.emplace_back(sequence, received_ns);
}

std::uint64_t BeaconProbe::missing(TimeNs ended_ns) const {
  // Topics have no order among each other: at the end some may still be on their way.
  constexpr TimeNs on_the_way_ns = 200'000'000;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::set<std::uint64_t> came;
  for (const auto& [sequence, received_ns] : numbers_) {
    came.insert(sequence);
    if (received_ns < began_ns_ || received_ns > ended_ns - on_the_way_ns) continue;
    if (first == 0 || sequence < first) first = sequence;
    last = std::max(last, sequence);
  }
  if (first == 0) return 0;
  const auto present = std::distance(came.lower_bound(first), came.upper_bound(last));
  return last - first + 1 - static_cast<std::uint64_t>(present);
}

std::optional<RestObservation> BeaconProbe::means(const calibration::Settings& calibration) const {
  constexpr std::size_t enough = 20;
  if (readings_.size() < enough) return std::nullopt;
  const auto count = static_cast<double>(readings_.size());
  ImuSample mean;
  for (const auto& [force, rate] : readings_) {
    mean.specific_force_body_mps2 += force / count;
    mean.angular_velocity_body_radps += rate / count;
  }
  Vector3d force_variance = Vector3d::Zero();
  Vector3d rate_variance = Vector3d::Zero();
  for (const auto& [force, rate] : readings_) {
    force_variance += (force - mean.specific_force_body_mps2).cwiseAbs2() / count;
    rate_variance += (rate - mean.angular_velocity_body_radps).cwiseAbs2() / count;
  }
  const ImuSample corrected = calibration::Calibration(calibration).corrected(mean);
  RestObservation rest;
  rest.mean_force_body_mps2 = corrected.specific_force_body_mps2;
  rest.mean_rate_body_radps = corrected.angular_velocity_body_radps;
  rest.force_std_mps2 = std::sqrt(force_variance.maxCoeff());
  rest.rate_std_radps = std::sqrt(rate_variance.maxCoeff());
  rest.fixes_span_m = fix_.samples < 2 ? 0.0 : (fixes_max_m_ - fixes_min_m_).norm();
  rest.axes = calibration.axes;
  return rest;
}

BeaconObservation BeaconProbe::seen(TimeNs now_ns, const calibration::Settings& calibration) const {
  BeaconObservation seen;
  seen.imu = imu_.seen(began_ns_, now_ns);
  seen.fix = fix_.seen(began_ns_, now_ns);
  seen.heading = heading_.seen(began_ns_, now_ns);
  seen.pose = pose_.seen(began_ns_, now_ns);
  seen.valid_headings = valid_headings_;
  seen.events_missing = missing(now_ns);
  if (!ahead_s_.empty()) {
    std::vector<double> sorted = ahead_s_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    seen.bridge_ahead_s = *middle;
  }
  seen.status_before = status_before_;
  seen.status = status_;
  for (const auto& entry : fusions_) {
    const FusionObservation& fusion = entry.second;
    seen.fusions.push_back(fusion.latest);
    if (seen.fusion && !observation::serves_before(fusion.latest, *seen.fusion)) continue;
    seen.fusion_before = fusion.before;
    seen.fusion = fusion.latest;
  }
  seen.lasting_status = pose_.samples > 0 ? lasting_status_ : 0;
  seen.imu_means = means(calibration);
  return seen;
}

calibration::Settings calibration_in(const EffectiveSettings& settings) {
  settings::Settings all;
  for (const auto& [key, value] : settings.values) {
    if (!key.starts_with("calibration.")) continue;
    try {
      settings::set(all, key, settings::parse_value(key, value));
    } catch (const settings::SettingError&) {
      continue;  // a fusion of another version: what it means is not known here
    }
  }
  return all.calibration;
}

}  // namespace sonopose::doctor
