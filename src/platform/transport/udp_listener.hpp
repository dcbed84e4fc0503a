#pragma once
/// \file
/// Receives beacon frames that a modem or the vendor's dashboard sends over UDP.

#include "transport/byte_source.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace sonopose::transport {

struct Endpoint {
  std::string address;  ///< numeric IPv4 or IPv6 address
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
};

/// Parses "ADDR:PORT", such as 0.0.0.0:49100 or [::]:49100. Throws std::invalid_argument with the cause.
Endpoint parse_endpoint(std::string_view text);

/// Throws std::invalid_argument unless the text is a numeric IPv4 or IPv6 address.
void check_address(const std::string& text);

/// Makes a source of one datagram per read(). A datagram that exceeds the buffer is truncated; 2048 bytes fit
/// any frame. Port 0 lets the system choose; name() has the chosen one. With `from`, a numeric address,
/// read() returns `refused` for each datagram of another address. Throws files::IoError if the address cannot
/// be bound, std::invalid_argument if that needs rights, or `from` is no address.
std::unique_ptr<ByteSource> open_udp_listener(const Endpoint& endpoint,
                                              const std::optional<std::string>& from = {});

}  // namespace sonopose::transport
