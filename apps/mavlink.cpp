// sonopose-mavlink: the poses of one beacon for an autopilot, over MAVLink.

#include "mavlink/sender/sender.hpp"
#include "support/bus_options.hpp"
#include "support/choice.hpp"
#include "support/log_option.hpp"
#include "support/north_option.hpp"
#include "support/options_file.hpp"
#include "support/waiting.hpp"

#include <array>
#include <charconv>
#include <stdexcept>
#include <string>
#include <system_error>

using namespace sonopose;

namespace {

/// The arguments before they are parsed into options.
struct Given {
  std::string udp;
  std::string device;
  std::string addresses;
  std::array<double, 6> mount{};
};

/// Splits "/dev/ttyTHS1:921600" at its last colon. Throws std::invalid_argument if no number follows, except
/// in /dev/serial/by-path, whose names have colons.
void set_device(const std::string& text, mavlink::sender::SenderOptions& options) {
  options.device = text;
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return;
  unsigned baud = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, baud);
  if (error != std::errc() || rest != end) {
    if (text.starts_with("/dev/serial/by-path/")) return;
    throw std::invalid_argument("--device " + text + ": '" + text.substr(colon + 1) + "' is not a baud rate");
  }
  options.device.resize(colon);
  options.baud = baud;
}

void apply(const Given& given, mavlink::sender::SenderOptions& options) {
  if (given.udp.empty() == given.device.empty()) {
    throw std::invalid_argument("give one of --udp and --device");
  }
  if (!given.udp.empty()) options.udp = transport::parse_endpoint(given.udp);
  if (options.udp && options.udp->port == 0) throw std::invalid_argument("--udp: port 0 cannot be sent to");
  set_device(given.device, options);
  if (!given.addresses.empty()) options.addresses = presence::AddressSet::parse(given.addresses);
  try {
    options.mount = ros2::mount_at(given.mount);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("--mount: ") + error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  using mavlink::sender::Message;
  apps::BusOptions bus;
  mavlink::sender::SenderOptions options;
  Given given;
  apps::Program app(
      "mavlink",
      "PX4 and ArduPilot need parameters, which docs/autopilots.md lists. No pose is sent before "
      "the autopilot's heartbeat.");
  add_bus_options(app, bus);
  logging::Level log_level = logging::Level::info;
  apps::add_log_option(app, log_level);
  auto udp =
      app.add_option("--udp", given.udp,
                     "Send to this endpoint, and then to the port of its host that heartbeats come from")
          .check(apps::readable_by(transport::parse_endpoint))
          .option_text("ADDRESS:PORT");
  app.add_option("--local-port", options.local_port, "With --udp: receive on this port; 0: any")
      .check(apps::number_between(0, 65535))
      .capture_default_str()
      .type_name("PORT")
      .needs(udp);
  app.add_option("--device", given.device, "Serial line to the autopilot (default: 921600 baud)")
      .option_text("PATH[:BAUD]")
      .excludes(udp);
  app.add_option("--addresses", given.addresses,
                 "Send the poses of the first of these beacons that is heard: 7 or 7-131 (default: all)")
      .check(apps::readable_by(presence::AddressSet::parse))
      .type_name("LIST");
  apps::add_choice<Message>(app, "--message", options.message,
                            {{"odometry", Message::odometry}, {"vision_position", Message::vision_position}},
                            "ODOMETRY, or VISION_POSITION_ESTIMATE, which has neither velocity nor quality");
  app.add_option("--rate", options.rate_hz, "Poses per second")
      .check(apps::number_between(1.0, 1000.0))
      .capture_default_str()
      .type_name("HZ");
  apps::add_north_option(app, options.north);
  app.add_option("--mount", given.mount, "Pose of the IMU on the vehicle: x y z (m) roll pitch yaw (deg)")
      .type_name("N");
  apps::add_options_file(app);
  return apps::run(app, argc, argv, [&] {
    apply(given, options);
    const logging::Session log(log_level);
    process::StopSignal stop;
    stop.listen_to_signals();
    if (!apps::wait_for_network(bus.domain, stop)) return 0;
    options.domain = bus.domain;
    options.qos_file = bus.qos_file;
    mavlink::sender::run(options, stop);
    return 0;
  });
}
