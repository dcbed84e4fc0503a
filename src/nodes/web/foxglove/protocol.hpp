#pragma once
/// \file
/// Server messages of Foxglove's WebSocket protocol, version 1: https://github.com/foxglove/ws-protocol,
/// docs/spec.md. Client messages are in requests.hpp.

#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sonopose::web::foxglove {

/// Sub-protocol names of this protocol.
inline constexpr std::array<std::string_view, 2> protocols{"foxglove.sdk.v1", "foxglove.websocket.v1"};

using ChannelId = std::uint32_t;
using SubscriptionId = std::uint32_t;

/// A stream that a client may subscribe to.
struct Channel {
  ChannelId id = 0;
  std::string topic;
  std::string encoding;
  std::string schema_name;
  std::string schema;
  std::string schema_encoding;
};

enum class StatusLevel : std::uint8_t { info, warning, error };

// Texts are JSON, the others are binary.
std::string server_info(const std::string& name, const std::string& session_id);
std::string advertise(std::span<const Channel> channels);
std::string status(StatusLevel level, const std::string& message);
std::string time(TimeNs time_ns);
/// `received_ns`: arrival time of the sample here.
std::string message_data(SubscriptionId subscription, TimeNs received_ns, std::span<const std::byte> payload);

}  // namespace sonopose::web::foxglove
