#include "web/recording/document.hpp"

#include "logging/log.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace sonopose::web::recording {
namespace {

/// More rows than that are not needed on a screen, and make the page slow.
constexpr double most_rows = 20'000;
constexpr TimeNs least_pose_period_ns = 40'000'000;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double known(double variance) {
  return variance >= 0 ? variance : unknown;
}

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace

Columns::Columns(std::vector<std::string_view> names, TimeNs begin_ns, TimeNs least_period_ns)
    : names_(std::move(names)),
      columns_(names_.size() + 1),
      begin_ns_(begin_ns),
      least_period_ns_(least_period_ns),
      next_ns_(std::numeric_limits<TimeNs>::min()) {}

void Columns::add(TimeNs time_ns, const std::vector<double>& values) {
  if (time_ns < next_ns_) return;
  next_ns_ = time_ns + least_period_ns_;
  columns_[0].push_back(seconds_between(begin_ns_, time_ns));
  for (std::size_t i = 0; i < values.size(); ++i) columns_[i + 1].push_back(values[i]);
}

std::string Columns::json() const {
  std::string text = "{";
  const auto append = [&text](std::string_view name, const std::vector<double>& values) {
    fmt::format_to(std::back_inserter(text), "{}\"{}\":[", text.size() > 1 ? "," : "", name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) text += ',';
      if (std::isfinite(values[i])) {
        fmt::format_to(std::back_inserter(text), "{:.7g}", values[i]);
      } else {
        text += "null";
      }
    }
    text += ']';
  };
  append("t", columns_[0]);
  for (std::size_t i = 0; i < names_.size(); ++i) append(names_[i], columns_[i + 1]);
  return text + '}';
}

Document::Beacon::Beacon(BeaconAddress address, TimeNs begin_ns, TimeNs least_period_ns)
    : poses({"x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "vz", "cxx", "cxy", "cyy", "czz", "yaw_std",
             "trust", "status", "since_fix"},
            begin_ns, std::max(least_period_ns, least_pose_period_ns)),
      fixes({"t_emission", "x", "y", "z", "ix", "iy", "iz", "ratio", "weight", "flags"}, begin_ns,
            least_period_ns),
      truth({"x", "y", "z", "yaw"}, begin_ns, std::max(least_period_ns, least_pose_period_ns)),
      watch(address) {}

Document::Document(double duration_s)
    : least_period_ns_(to_ns(duration_s / most_rows)), transition_log_([this](const transitions::Line& line) {
        const bool is_info = line.level <= logging::Level::info;
        const char* const level = is_info                                 ? "info"
                                  : line.level == logging::Level::warning ? "warning"
                                                                          : "error";
        const nlohmann::json event{
            {"t", 1e-9 * static_cast<double>(now_ns_)}, {"level", level}, {"text", line.text}};
        events_ += (events_.empty() ? "" : ",") + event.dump();
      }) {}

Document::Beacon& Document::beacon(BeaconAddress address, TimeNs time_ns) {
  if (beacons_.empty()) begin_ns_ = end_ns_ = time_ns;
  end_ns_ = std::max(end_ns_, time_ns);
  return beacons_.try_emplace(address, address, begin_ns_, least_period_ns_).first->second;
}

void Document::take(transitions::Pending& pending, TimeNs time_ns) {
  now_ns_ = time_ns;
  transition_log_.take(pending, SteadyTime{time_ns});
}

void Document::add(const FusedPose& pose) {
  Beacon& beacon = this->beacon(pose.address, pose.time_ns);
  const auto angles = geometry::euler_angles_of(pose.q_body_to_world);
  const bool has_position = (pose.status & status_initialising) == 0;
  const Vector3d position = has_position ? pose.position_world_m : Vector3d::Constant(unknown);
  const auto& velocity = pose.velocity_world_mps;
  const auto& covariance = pose.pose_covariance;
  const bool is_known = covariance.is_known(0);
  beacon.poses.add(pose.time_ns,
                   {position.x(), position.y(), position.z(), angles.roll_rad, angles.pitch_rad,
                    angles.yaw_rad, velocity.x(), velocity.y(), velocity.z(),
                    is_known ? covariance.at(0, 0) : unknown, is_known ? covariance.at(0, 1) : unknown,
                    is_known ? covariance.at(1, 1) : unknown, known(covariance.at(2, 2)), yaw_std_rad(pose),
                    pose.trust, static_cast<double>(pose.status), pose.since_valid_fix_s});
  transitions::Pending pending;
  beacon.watch.on(pose, pending);
  take(pending, pose.time_ns);
}

void Document::add(const FixReport& report) {
  if (report.hypothesis != 0) return;  // the poses are of the main one
  Beacon& beacon = this->beacon(report.address, report.applied_time_ns);
  const auto& position = report.position_world_m;
  const auto& innovation = report.innovation_world_m;
  beacon.fixes.add(report.applied_time_ns,
                   {seconds_between(begin_ns_, report.emission_time_ns), position.x(), position.y(),
                    position.z(), innovation.x(), innovation.y(), innovation.z(),
                    report.test_ratio.value_or(unknown), report.weight, static_cast<double>(report.flags)});
  transitions::Pending pending;
  beacon.watch.on(report, pending);
  take(pending, report.applied_time_ns);
}

void Document::add(const TruthSample& truth) {
  const auto& position = truth.position_world_m;
  beacon(truth.address, truth.time_ns)
      .truth.add(truth.time_ns,
                 {position.x(), position.y(), position.z(), geometry::yaw_of(truth.q_body_to_world)});
}

void Document::add(const StationaryBeacon& beacon) {
  if (beacon.position_world_m) stationary_world_m_[beacon.address] = *beacon.position_world_m;
}

bool Document::has_poses() const {
  return std::any_of(beacons_.begin(), beacons_.end(),
                     [](const auto& entry) { return entry.second.poses.size() > 0; });
}

std::string Document::json() {
  transition_log_.finish();
  std::string text =
      fmt::format(R"({{"begin":{:.4f},"duration":{:.4f},"events":[{}],"stationary":[)",
                  1e-9 * static_cast<double>(begin_ns_), seconds_between(begin_ns_, end_ns_), events_);
  std::string separator;
  for (const auto& [address, position_m] : stationary_world_m_) {
    text += separator + nlohmann::json{{"a", address},
                                       {"x", number(position_m.x())},
                                       {"y", number(position_m.y())},
                                       {"z", number(position_m.z())}}
                            .dump();
    separator = ",";
  }
  text += R"(],"beacons":[)";
  separator.clear();
  for (const auto& [address, beacon] : beacons_) {
    const std::size_t rows = std::max({beacon.poses.size(), beacon.fixes.size(), beacon.truth.size()});
    text += fmt::format(R"({}{{"address":{},"rows":{},"poses":{},"fixes":{},"truth":{}}})", separator,
                        address, rows, beacon.poses.json(), beacon.fixes.json(), beacon.truth.json());
    separator = ",";
  }
  return text + "]}";
}

}  // namespace sonopose::web::recording
