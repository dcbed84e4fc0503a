#include "web/metrics.hpp"

#include "observation/status_counters.hpp"
#include "observation/status_words.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

namespace sonopose::web {
namespace {

using observation::BeaconView;
using observation::Percentiles;
using Views = std::vector<BeaconView>;

/// Writes one metric after the other, each with all its beacons, as the format demands.
class Writer {
public:
  explicit Writer(const Views& beacons) : beacons_(beacons) {}

  /// Writes a metric for the beacons that have a value.
  void add(std::string_view name, std::string_view type, std::string_view help,
           const std::function<std::optional<double>(const BeaconView&)>& value) {
    begin(name, type, help);
    for (const BeaconView& view : beacons_) {
      if (const auto number = value(view)) row(name, view, "", *number);
    }
  }

  void begin(std::string_view name, std::string_view type, std::string_view help) {
    fmt::format_to(std::back_inserter(text_), "# HELP sonopose_{0} {2}\n# TYPE sonopose_{0} {1}\n", name,
                   type, help);
  }

  /// Writes a value with more labels, such as `,axis="x"`.
  void row(std::string_view name, const BeaconView& view, std::string_view labels, double value) {
    if (std::isnan(value)) return;  // not known
    const std::string number = std::isinf(value) ? (value > 0 ? "+Inf" : "-Inf") : fmt::format("{}", value);
    fmt::format_to(std::back_inserter(text_), "sonopose_{}{{beacon=\"{}\"{}}} {}\n", name, view.address,
                   labels, number);
  }

  std::string take() { return std::move(text_); }

private:
  const Views& beacons_;
  std::string text_;
};

bool has_poses(const BeaconView& view) {
  return view.pose.time_ns != 0;
}

void add_pose(Writer& out, const Views& beacons, TimeNs now_ns) {
  out.add("pose_rate_hz", "gauge", "Poses at IMU samples in the last second.",
          [](const BeaconView& view) { return view.pose_rate_hz; });
  const auto latency = [](double Percentiles::*quantile) {
    return [quantile](const BeaconView& view) {
      return view.poses > 0 ? std::optional(view.latency.*quantile) : std::nullopt;
    };
  };
  out.add("pose_latency_p50_seconds", "gauge", "Median from the bridge's publication to the reception here.",
          latency(&Percentiles::p50_s));
  out.add("pose_latency_p99_seconds", "gauge",
          "99th percentile of the latency from the bridge's publication to the reception here.",
          latency(&Percentiles::p99_s));
  out.add("pose_age_seconds", "gauge", "Age of the last pose.",
          [now_ns](const BeaconView& view) -> std::optional<double> {
            if (!has_poses(view)) return {};
            return static_cast<double>(now_ns - view.pose.time_ns) * 1e-9;
          });
  out.begin("position_std_meters", "gauge", "Standard deviation of the position.");
  for (const BeaconView& view : beacons) {
    if (!has_poses(view)) continue;
    const Vector3d std_m = position_std_m(view.pose);
    out.row("position_std_meters", view, ",axis=\"x\"", std_m.x());
    out.row("position_std_meters", view, ",axis=\"y\"", std_m.y());
    out.row("position_std_meters", view, ",axis=\"z\"", std_m.z());
  }
  out.begin("pose_status", "gauge", "1 if the last pose has this condition, 0 otherwise.");
  for (const BeaconView& view : beacons) {
    for (std::uint32_t bit = 1; bit != 0 && has_poses(view); bit <<= 1U) {
      const std::string words = observation::status_words(bit);
      if (words == "ok") continue;  // no such condition
      out.row("pose_status", view, fmt::format(",condition=\"{}\"", words),
              (view.pose.status & bit) != 0U ? 1.0 : 0.0);
    }
  }
  out.add("pose_deadlines_missed_total", "counter", "Deadline periods without a pose.",
          [](const BeaconView& view) { return static_cast<double>(view.deadlines_missed); });
  out.add("pose_losses_total", "counter", "Number of times that the pose stream lost its last fusion.",
          [](const BeaconView& view) { return static_cast<double>(view.losses); });
}

void add_fixes(Writer& out) {
  out.add("fix_innovation_meters", "gauge", "Distance of the last fix from its prediction.",
          [](const BeaconView& view) -> std::optional<double> {
            if (!view.report) return {};
            return view.report->innovation_world_m.norm();
          });
  out.add("fixes_used_ratio", "gauge", "Share of the fixes that were used since the fusion started.",
          [](const BeaconView& view) -> std::optional<double> {
            if (!view.fusion) return {};
            const auto used = static_cast<double>(view.fusion->fixes_used);
            const double all = used + static_cast<double>(view.fusion->fixes_rejected);
            return all > 0 ? std::optional(used / all) : std::nullopt;
          });
}

void add_bridge(Writer& out) {
  const auto of_bridge = [](double BeaconStatus::*field) {
    return [field](const BeaconView& view) {
      return view.bridge ? std::optional((*view.bridge).*field) : std::nullopt;
    };
  };
  out.add("imu_rate_hz", "gauge", "IMU samples of the last second.", of_bridge(&BeaconStatus::imu_rate_hz));
  out.add("fix_rate_hz", "gauge", "Fixes of the last second.", of_bridge(&BeaconStatus::fix_rate_hz));
  out.add("heading_rate_hz", "gauge", "Headings of the last second.",
          of_bridge(&BeaconStatus::heading_rate_hz));
  out.add("bridge_other_bridges", "gauge", "Other bridges that publish this beacon.",
          [](const BeaconView& view) -> std::optional<double> {
            if (!view.bridge) return {};
            return static_cast<double>(view.bridge->other_bridges);
          });
  out.add("battery_volts", "gauge", "Voltage of the beacon's battery.",
          [](const BeaconView& view) -> std::optional<double> {
            if (!view.bridge) return {};
            return view.bridge->battery_v;
          });
}

/// Adds the counters of a status, which every consumer names alike.
template <class Counters, class StatusOf>
void add_counters(Writer& out, const Counters& counters, std::string_view process,
                  const StatusOf& status_of) {
  for (const auto& counter : counters) {
    out.add(fmt::format("{}_{}_total", process, counter.name), "counter",
            fmt::format("Field {} of the status of the {}.", counter.name, process),
            [&](const BeaconView& view) -> std::optional<double> {
              const auto& status = status_of(view);
              if (!status) return {};
              return static_cast<double>((*status).*counter.value);
            });
  }
}

}  // namespace

std::string metrics_text(const Views& beacons, TimeNs now_ns,
                         const std::map<std::string, std::int64_t>& expiries_s) {
  Writer out(beacons);
  add_pose(out, beacons, now_ns);
  add_fixes(out);
  add_bridge(out);
  add_counters(
      out, observation::bridge_counters, "bridge",
      [](const BeaconView& view) -> const auto& { return view.bridge; });
  add_counters(
      out, observation::fusion_counters, "fusion",
      [](const BeaconView& view) -> const auto& { return view.fusion; });
  std::string text = out.take();
  if (expiries_s.empty()) return text;
  text +=
      "# HELP sonopose_enclave_expiry_seconds Time since 1970 at which a certificate expires.\n"
      "# TYPE sonopose_enclave_expiry_seconds gauge\n";
  for (const auto& [enclave, expires_s] : expiries_s) {
    text += fmt::format("sonopose_enclave_expiry_seconds{{enclave=\"{}\"}} {}\n", enclave, expires_s);
  }
  return text;
}

std::string why_not_ready(const Views& beacons) {
  if (beacons.empty()) return "no beacon is on the bus";
  std::string without;
  for (const BeaconView& view : beacons) {
    if (view.poses == 0 || view.lost) without += fmt::format(" {}", view.address);
  }
  return without.empty() ? "" : "no poses of beacon" + without;
}

void Metrics::update(const Views& beacons, TimeNs now_ns, SteadyTime now) {
  std::string text = metrics_text(beacons, now_ns, expiries_s_);
  std::string reason = why_not_ready(beacons);
  const threads::Lock lock(mutex_);
  text_ = std::move(text);
  why_not_ready_ = std::move(reason);
  updated_ = now;
}

std::optional<http::Response> Metrics::get(std::string_view path, SteadyTime now) const {
  constexpr TimeNs max_age_ns = 5'000'000'000;
  const threads::Lock lock(mutex_);
  if (path != "/metrics" && path != "/healthz" && path != "/readyz") return {};
  if (now - updated_ > max_age_ns) return http::text_response(503, "the bus was not observed for 5 s\n");
  if (path == "/metrics") {
    return http::Response{200, "text/plain; version=0.0.4; charset=utf-8", http::shared_text(text_)};
  }
  if (path == "/healthz" || why_not_ready_.empty()) return http::text_response(200, "ok\n");
  return http::text_response(503, why_not_ready_ + "\n");
}

}  // namespace sonopose::web
