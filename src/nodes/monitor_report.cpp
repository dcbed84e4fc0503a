#include <sonopose/math/rotation.hpp>
#include <sonopose/nodes/monitor_report.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <string_view>
#include <utility>

namespace sonopose::nodes {
namespace {

constexpr std::array<std::pair<PoseStatus, std::string_view>, 10> status_names{{
    {status_initialising, "initialising"},
    {status_uncalibrated, "uncalibrated"},
    {status_stale, "stale"},
    {status_converging, "converging"},
    {status_heading_unknown, "heading unknown"},
    {status_frozen_track, "frozen track"},
    {status_predicted, "predicted"},
    {status_imu_gap, "IMU gap"},
    {status_low_trust, "low trust"},
    {status_rotating_fast, "rotating fast"},
}};

double heading_deg(const FusedPose& pose) {
  return math::yaw_of(pose.q_body_to_world) / math::radians_per_degree;
}

/// Milliseconds to two places, or a dash where not known.
std::string ms(double seconds) {
  return seconds == seconds ? fmt::format("{:.2f}", seconds * 1e3) : "-";
}

std::uint64_t lost_events(const BeaconView& view) {
  return view.fusion ? view.fusion->events_lost : 0;
}

nlohmann::json vector_json(const Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

nlohmann::json optional_json(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json beacon_json(const BeaconView& view) {
  const FusedPose& pose = view.pose;
  nlohmann::json json{{"address", view.address},
                      {"poses", view.poses},
                      {"pose_rate_hz", view.pose_rate_hz},
                      {"latency_p50_s", view.latency.p50_s},
                      {"latency_p99_s", view.latency.p99_s},
                      {"position_m", vector_json(pose.position_world_m)},
                      {"orientation_wxyz",
                       {pose.q_body_to_world.w(), pose.q_body_to_world.x(), pose.q_body_to_world.y(),
                        pose.q_body_to_world.z()}},
                      {"heading_deg", heading_deg(pose)},
                      {"velocity_mps", vector_json(pose.velocity_world_mps)},
                      {"speed_mps", pose.velocity_world_mps.norm()},
                      {"position_std_m", vector_json(pose.position_std_m)},
                      {"since_valid_fix_s", pose.since_valid_fix_s},
                      {"trust", pose.trust},
                      {"status", pose.status},
                      {"status_words", status_words(pose.status)},
                      {"reset_counter", pose.reset_counter},
                      {"pose_time_ns", pose.time_ns},
                      {"pose_deadlines_missed", view.deadlines_missed},
                      {"position_error_rms_m", optional_json(view.position_error_rms_m)},
                      {"position_error_max_m", optional_json(view.position_error_max_m)}};
  if (view.bridge) {
    const BeaconStatus& bridge = *view.bridge;
    json["bridge"] = {{"imu_rate_hz", bridge.imu_rate_hz},
                      {"fix_rate_hz", bridge.fix_rate_hz},
                      {"heading_rate_hz", bridge.heading_rate_hz},
                      {"battery_v", optional_json(bridge.battery_v)},
                      {"rssi_dbm", optional_json(bridge.rssi_dbm)},
                      {"clock_offset_s", bridge.clock_offset_s},
                      {"clock_jitter_s", bridge.clock_jitter_s},
                      {"frames", bridge.frames},
                      {"crc_errors", bridge.crc_errors},
                      {"bytes_lost", bridge.bytes_lost},
                      {"fixes_unavailable", bridge.fixes_unavailable},
                      {"other_bridges", bridge.other_bridges}};
  }
  if (view.fusion) {
    const FusionStatus& fusion = *view.fusion;
    json["fusion"] = {
        {"imu_samples", fusion.imu_samples},         {"fixes_used", fusion.fixes_used},
        {"fixes_rejected", fusion.fixes_rejected},   {"headings", fusion.headings},
        {"events_lost", fusion.events_lost},         {"events_duplicated", fusion.events_duplicated},
        {"samples_invalid", fusion.samples_invalid}, {"imu_gaps", fusion.imu_gaps}};
  }
  return json;
}

}  // namespace

std::string status_words(std::uint32_t status) {
  std::string words;
  for (const auto& [bit, name] : status_names) {
    if ((status & bit) == 0U) continue;
    if (!words.empty()) words += ", ";
    words += name;
  }
  return words.empty() ? "ok" : words;
}

std::string table_of(const std::vector<BeaconView>& views) {
  std::string text =
      "beacon  pose/IMU/fix Hz      x       y       z m   heading  m/s    latency p50/p99 ms  lost  status\n";
  for (const BeaconView& view : views) {
    const FusedPose& pose = view.pose;
    text += fmt::format(
        "{:>6}  {:>5.1f}/{:>5.1f}/{:>4.1f}  {:>7.3f} {:>7.3f} {:>7.3f}  {:>6.1f}°  {:>5.2f}  {:>8}/{:>8}  "
        "{:>6}  {}\n",
        view.address, view.pose_rate_hz, view.bridge ? view.bridge->imu_rate_hz : 0.0,
        view.bridge ? view.bridge->fix_rate_hz : 0.0, pose.position_world_m.x(), pose.position_world_m.y(),
        pose.position_world_m.z(), heading_deg(pose), pose.velocity_world_mps.norm(), ms(view.latency.p50_s),
        ms(view.latency.p99_s), lost_events(view), view.poses == 0 ? "silent" : status_words(pose.status));
  }
  return text;
}

std::string json_of(const std::vector<BeaconView>& views, TimeNs now_ns) {
  nlohmann::json json{{"time_ns", now_ns}, {"beacons", nlohmann::json::array()}};
  for (const BeaconView& view : views) json["beacons"].push_back(beacon_json(view));
  return json.dump();
}

std::string summary_of(const std::vector<BeaconView>& views) {
  if (views.empty()) return "no pose was seen\n";
  std::string text;
  for (const BeaconView& view : views) {
    text += fmt::format("beacon {} over {:.1f} s\n", view.address, view.window_s);
    text += fmt::format("  poses            {} ({:.1f} Hz)\n", view.poses, view.pose_rate_hz);
    if (view.bridge) {
      text += fmt::format("  IMU, fix rate    {:.1f} Hz, {:.1f} Hz\n", view.bridge->imu_rate_hz,
                          view.bridge->fix_rate_hz);
    }
    text += fmt::format("  latency          p50 {} ms, p99 {} ms (bridge to here)\n", ms(view.latency.p50_s),
                        ms(view.latency.p99_s));
    if (view.position_error_rms_m) {
      text +=
          fmt::format("  position error   {:.1f} cm RMS, {:.1f} cm at most (against the simulator's truth)\n",
                      *view.position_error_rms_m * 1e2, *view.position_error_max_m * 1e2);
    }
    if (view.fusion) {
      text += fmt::format("  fixes            {} used, {} rejected\n", view.fusion->fixes_used,
                          view.fusion->fixes_rejected);
    }
    text += fmt::format("  lost             {} events, {} pose deadlines missed\n", lost_events(view),
                        view.deadlines_missed);
  }
  return text;
}

}  // namespace sonopose::nodes
