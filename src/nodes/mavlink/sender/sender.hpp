#pragma once
/// \file
/// sonopose-mavlink: the poses of one beacon for an autopilot.

#include "autopilot/external_odometry.hpp"
#include "presence/address_set.hpp"
#include "process/stop_signal.hpp"
#include "transport/udp_listener.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/ros2/messages/frames.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::mavlink::sender {

enum class Message : std::uint8_t { odometry, vision_position };

struct SenderOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::optional<transport::Endpoint> udp;  ///< empty: the serial device
  std::uint16_t local_port = 0;
  std::string device;
  unsigned baud = 921600;
  Message message = Message::odometry;
  double rate_hz = 30;
  autopilot::North north;
  ros2::Mount mount;
  presence::AddressSet addresses;  ///< the first beacon of these that is heard is served
};

/// Sends poses and heartbeats, and answers the autopilot's time synchronisation, until the stop. Throws if
/// the line cannot be used, dds::core::Exception.
void run(const SenderOptions& options, const process::StopSignal& stop);

}  // namespace sonopose::mavlink::sender
