#include "monitor/monitor_report.hpp"

#include "monitor/estimate_table.hpp"
#include "monitor/order.hpp"
#include "monitor/words.hpp"
#include <sonopose/text/count_text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace sonopose::monitor {
namespace {

/// "0.03/0.12": median and 99th percentile in milliseconds.
std::string ms_pair(const observation::Percentiles& percentiles) {
  return ms(percentiles.p50_s) + "/" + ms(percentiles.p99_s);
}

std::string sensor_to_bridge_words(const observation::BeaconView& view) {
  return std::isnan(view.segments[0].p50_s) ? "– old stamps" : ms_pair(view.segments[0]);
}

std::string worst_words(const observation::PoseTrace& worst) {
  const auto segments_s = worst.segments_s();
  return fmt::format("{} = {} + {} + {} (event {})", ms(worst.latency_s()), ms(segments_s[1]),
                     ms(segments_s[2]), ms(segments_s[3]), worst.sequence);
}

std::string segments_table_of(const std::vector<observation::BeaconView>& views) {
  std::string text =
      "beacon  sensor > bridge   > fusion     fusing      > here   p50/p99 ms   worst: bridge to here ms\n";
  for (const observation::BeaconView& view : views) {
    if (!view.worst) continue;
    text += fmt::format("{:>6}  {:>15}  {:>11}  {:>9}  {:>11}                {}\n", view.address,
                        sensor_to_bridge_words(view), ms_pair(view.segments[1]), ms_pair(view.segments[2]),
                        ms_pair(view.segments[3]), worst_words(*view.worst));
  }
  return text;
}

std::uint64_t lost_events(const observation::BeaconView& view) {
  return view.fusion ? view.fusion->events_lost : 0;
}

std::string row_of(const observation::BeaconView& view) {
  const FusedPose& pose = view.pose;
  const auto of_pose = [&view](double value, int decimals) {
    return has_pose(view) ? number(value, decimals) : std::string(unknown);
  };
  const auto of_bridge = [&view](double BeaconStatus::*rate_hz) {
    return view.bridge ? number((*view.bridge).*rate_hz, 1) : std::string(unknown);
  };
  const std::string lost = view.fusion ? fmt::format("{}", view.fusion->events_lost) : std::string(unknown);
  return fmt::format(
      "{:>6}  {:>5.1f}/{:>5}/{:>4}  {:>7} {:>7} {:>7}  {:>6}°  {:>5}  {:>8}/{:>8}  {:>6}  {}\n", view.address,
      view.pose_rate_hz, of_bridge(&BeaconStatus::imu_rate_hz), of_bridge(&BeaconStatus::fix_rate_hz),
      of_pose(pose.position_world_m.x(), 3), of_pose(pose.position_world_m.y(), 3),
      of_pose(pose.position_world_m.z(), 3), of_pose(heading_deg(pose), 1),
      of_pose(pose.velocity_world_mps.norm(), 2), ms(view.latency.p50_s), ms(view.latency.p99_s), lost,
      stream_words(view));
}

}  // namespace

std::string table_of(const std::vector<observation::BeaconView>& views,
                     const std::vector<std::string>& warnings) {
  std::string text =
      "beacon  pose/IMU/fix Hz      x       y       z m   heading  m/s    latency p50/p99 ms  lost  status\n";
  for (const observation::BeaconView& view : views) text += row_of(view);
  text += segments_table_of(views);
  text += estimate_table_of(views);
  for (const observation::BeaconView& view : views) text += problems_of(view);
  for (const std::string& warning : warnings) text += fmt::format("warning: {}\n", text::escaped(warning));
  return text;
}

std::string summary_of(const std::vector<observation::BeaconView>& views) {
  if (views.empty()) return "no pose received\n";
  std::string text;
  for (const observation::BeaconView& view : views) {
    text += fmt::format("beacon {} over {:.1f} s\n", view.address, view.window_s);
    text += fmt::format("  poses            {} ({:.1f} Hz)\n", view.poses, view.pose_rate_hz);
    if (view.bridge) {
      text += fmt::format("  IMU, fix rate    {:.1f} Hz, {:.1f} Hz\n", view.bridge->imu_rate_hz,
                          view.bridge->fix_rate_hz);
    }
    text += fmt::format("  latency          p50 {} ms, p99 {} ms (bridge to here)\n", ms(view.latency.p50_s),
                        ms(view.latency.p99_s));
    if (view.worst) {
      text += fmt::format("  segments         {} to the fusion, {} in it, {} to here (p50/p99 ms)\n",
                          ms_pair(view.segments[1]), ms_pair(view.segments[2]), ms_pair(view.segments[3]));
      text += fmt::format("  slowest pose     {} ms\n", worst_words(*view.worst));
    }
    if (view.position_error_rms_m) {
      text +=
          fmt::format("  position error   {:.1f} cm RMS, {:.1f} cm at most (against the simulator's truth)\n",
                      *view.position_error_rms_m * 1e2, *view.position_error_max_m * 1e2);
    }
    if (view.fusion) {
      text += fmt::format("  fixes            {} used, {} of them down-weighted, {} rejected ({} too late)\n",
                          view.fusion->fixes_used, view.fusion->fixes_down_weighted,
                          view.fusion->fixes_rejected, view.fusion->fixes_late);
    }
    text +=
        fmt::format("  lost             {}, {}\n", text::count_text(lost_events(view), "event"),
                    text::count_text(view.deadlines_missed, "pose deadline missed", "pose deadlines missed"));
    text += problems_of(view);
  }
  return text;
}

}  // namespace sonopose::monitor
