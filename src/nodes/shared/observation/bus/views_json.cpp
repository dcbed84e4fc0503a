#include "observation/bus/views_json.hpp"

#include "observation/status_counters.hpp"
#include "observation/status_words.hpp"
#include "observation/stream_state.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <string>

namespace sonopose::observation::bus {
namespace {

nlohmann::json vector_json(const Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

nlohmann::json optional_json(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json segments_json(const BeaconView& view) {
  nlohmann::json json;
  for (std::size_t i = 0; i < latency_segment_names.size(); ++i) {
    json[std::string(latency_segment_names[i])] = {{"p50_s", view.segments[i].p50_s},
                                                   {"p99_s", view.segments[i].p99_s}};
  }
  return json;
}

nlohmann::json trace_json(const PoseTrace& trace) {
  return {{"event_sequence", trace.sequence},
          {"latency_s", trace.latency_s()},
          {"sensor_time_ns", trace.sensor_ns},
          {"bridge_time_ns", trace.bridge_ns},
          {"fusion_in_time_ns", trace.fusion_in_ns},
          {"fusion_out_time_ns", trace.fusion_out_ns},
          {"here_time_ns", trace.here_ns}};
}

template <class Status, std::size_t Size>
void add_counters(const std::array<StatusCounter<Status>, Size>& counters, const Status& status,
                  nlohmann::json& json) {
  for (const auto& counter : counters) json[std::string(counter.name)] = status.*counter.value;
}

nlohmann::json bridge_json(const BeaconStatus& bridge) {
  nlohmann::json json{
      {"imu_rate_hz", bridge.imu_rate_hz},          {"fix_rate_hz", bridge.fix_rate_hz},
      {"heading_rate_hz", bridge.heading_rate_hz},  {"battery_v", optional_json(bridge.battery_v)},
      {"rssi_dbm", optional_json(bridge.rssi_dbm)}, {"clock_offset_s", bridge.clock_offset_s},
      {"clock_jitter_s", bridge.clock_jitter_s},    {"other_bridges", bridge.other_bridges}};
  add_counters(bridge_counters, bridge, json);
  return json;
}

nlohmann::json fusion_json(const FusionStatus& fusion) {
  constexpr std::array<const char*, 4> roles{"sole", "warming", "serving", "stalled"};
  nlohmann::json json{{"fusion_id", fusion.fusion_id},
                      {"role", roles[static_cast<std::size_t>(fusion.role)]},
                      {"strength", fusion.strength},
                      {"imu_silent", fusion.imu_silent},
                      {"overloaded", fusion.overloaded}};
  add_counters(fusion_counters, fusion, json);
  return json;
}

/// {"value": …, "std": …}, with null for an unknown standard deviation; null if there is no estimate.
nlohmann::json value_json(const std::optional<ScalarEstimate>& estimate) {
  if (!estimate) return {};
  const bool known = estimate->std >= 0.0;
  return {{"value", estimate->value}, {"std", known ? nlohmann::json(estimate->std) : nlohmann::json()}};
}

nlohmann::json value_json(const std::optional<VectorEstimate>& estimate) {
  if (!estimate) return {};
  const bool known = estimate->std.minCoeff() >= 0.0;
  return {{"value", vector_json(estimate->value)},
          {"std", known ? vector_json(estimate->std) : nlohmann::json()}};
}

nlohmann::json estimate_json(const Estimate& estimate) {
  return {{"fusion_id", estimate.fusion_id},
          {"time_ns", estimate.time_ns},
          {"gyro_bias_radps", value_json(estimate.gyro_bias_body_radps)},
          {"accelerometer_bias_mps2", value_json(estimate.accelerometer_bias_body_mps2)},
          {"lever_arm_m", value_json(estimate.lever_arm_body_m)},
          {"delay_s", value_json(estimate.delay_s)},
          {"fix_noise_m", value_json(estimate.fix_noise_m)},
          {"heading_noise_rad", value_json(estimate.heading_noise_rad)}};
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
                      {"heading_deg", geometry::yaw_of(pose.q_body_to_world) / geometry::radians_per_degree},
                      {"velocity_mps", vector_json(pose.velocity_world_mps)},
                      {"speed_mps", pose.velocity_world_mps.norm()},
                      {"position_std_m", vector_json(position_std_m(pose))},
                      {"since_valid_fix_s", pose.since_valid_fix_s},
                      {"trust", pose.trust},
                      {"status", pose.status},
                      {"status_words", status_words(pose.status)},
                      {"stream", stream_words(view)},
                      {"severity", severity_of(view)},
                      {"reset_counter", pose.reset_counter},
                      {"pose_time_ns", pose.time_ns},
                      {"pose_deadlines_missed", view.deadlines_missed},
                      {"pose_losses", view.losses},
                      {"lost", view.lost},
                      {"predicted", view.predicted},
                      {"latency_segments", segments_json(view)},
                      {"worst", view.worst ? trace_json(*view.worst) : nlohmann::json()},
                      {"position_error_rms_m", optional_json(view.position_error_rms_m)},
                      {"position_error_max_m", optional_json(view.position_error_max_m)}};
  if (view.bridge) json["bridge"] = bridge_json(*view.bridge);
  if (view.fusion) json["fusion"] = fusion_json(*view.fusion);
  if (view.estimate) json["estimate"] = estimate_json(*view.estimate);
  json["fusions"] = nlohmann::json::array();
  for (const FusionStatus& fusion : view.fusions) json["fusions"].push_back(fusion_json(fusion));
  return json;
}

}  // namespace

std::string json_of(const std::vector<BeaconView>& views, const std::vector<std::string>& warnings,
                    TimeNs now_ns) {
  nlohmann::json json{{"time_ns", now_ns}, {"beacons", nlohmann::json::array()}, {"warnings", warnings}};
  for (const BeaconView& view : views) json["beacons"].push_back(beacon_json(view));
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);  // a text need not be UTF-8
}

}  // namespace sonopose::observation::bus
