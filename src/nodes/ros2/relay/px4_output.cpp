#include "ros2/relay/px4_output.hpp"

#include "autopilot/px4.hpp"
#include "clocks/clocks.hpp"

#include <fmt/format.h>

namespace sonopose::ros2::relay {
namespace {

using autopilot::Silence;

/// "uav_1", "/uav_1" or "/" for none → "/uav_1" or "".
std::string prefix_of(const std::string& name_space) {
  if (name_space.empty() || name_space == "/") return "";
  const std::string absolute = name_space.starts_with('/') ? name_space : "/" + name_space;
  ros2::check_namespace(absolute);
  return absolute;
}

}  // namespace

Px4Output::Px4Output(ros2::Node& node, const AutopilotOptions& options, Log& log)
    : odometry_topic_(prefix_of(options.name_space) + "/fmu/in/vehicle_visual_odometry"),
      clock_topic_(prefix_of(options.name_space) + "/fmu/out/timesync_status"),
      north_(options.north_rad),
      log_(log),
      rate_(options.rate_hz),
      writer_(node.make_writer<ros2::VehicleOdometry>(odometry_topic_, "ros2::Default")),
      clock_reader_(node.make_reader<ros2::TimesyncStatus>(clock_topic_, "ros2::Input", &listener_)) {}

void Px4Output::ClockListener::on_data_available(dds::DataReader<ros2::TimesyncStatus>& reader) noexcept {
  reader.try_take_each([this](const ros2::TimesyncStatus& status, const dds::SampleInfo&) {
    if (status.timestamp >= static_cast<std::uint64_t>(end_of_time_ns / 1000)) return;
    const threads::Lock lock(output_.mutex_);
    output_.clock_.on(static_cast<TimeNs>(status.timestamp) * 1000, clocks::host_now(), clocks::steady_now());
  });
}

void Px4Output::on(const FusedPose& pose, const ros2::Mount& mount) {
  if (const auto message = message_for(pose, mount)) writer_.try_write(*message);
}

std::optional<ros2::VehicleOdometry> Px4Output::message_for(const FusedPose& pose, const ros2::Mount& mount) {
  const threads::Lock lock(mutex_);
  if (!address_) address_ = pose.address;
  if (*address_ != pose.address) {
    other_ = pose.address;
    return std::nullopt;
  }
  const SteadyTime now = clocks::steady_now();
  const auto verdict = watch_.on(pose);
  const auto odometry = autopilot::external_odometry(pose, mount, north_);
  const auto measured_ns = clock_.at(pose.time_ns, now);
  const auto now_ns = clock_.at(clocks::host_now(), now);
  state_ = verdict.silence;
  if (state_ == Silence::none && !odometry.q_body_to_frame && !north_) state_ = Silence::yaw_unknown;
  if (state_ == Silence::none && (!measured_ns || !now_ns)) state_ = Silence::no_clock;
  if (state_ != Silence::none || !stamp_.next(pose.time_ns) || !rate_.admits(pose.time_ns)) {
    return std::nullopt;
  }
  return autopilot::vehicle_odometry(odometry, *measured_ns, *now_ns, watch_.take_reset_counter(),
                                     verdict.quality_percent);
}

void Px4Output::log_changes() {
  std::optional<Silence> state;
  std::optional<BeaconAddress> other;
  BeaconAddress address = 0;
  {
    const threads::Lock lock(mutex_);
    state = state_;
    other = other_;
    address = address_.value_or(address);
  }
  if (other && !logged_others_) {
    log_.warning(
        fmt::format("PX4 gets the poses of beacon {}; those of others, such as {}, are not sent: "
                    "--addresses selects it",
                    address, *other));
    logged_others_ = true;
  }
  if (state == logged_) return;
  logged_ = state;
  if (state == Silence::none) {
    log_.info(fmt::format("PX4: the poses of beacon {} are sent on {}", address, odometry_topic_));
  } else if (state == Silence::no_clock) {
    log_.warning(
        fmt::format("PX4: no poses are sent, because its clock is unknown: nothing arrives on {}; "
                    "are PX4 and the Micro-XRCE-DDS agent connected?",
                    clock_topic_));
  } else {
    log_.warning(fmt::format("PX4: no poses of beacon {} are sent: {}", address, text_of(*state)));
  }
}

}  // namespace sonopose::ros2::relay
