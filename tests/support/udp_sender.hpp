#pragma once
/// \file
/// A beacon that sends datagrams to this machine.

#include "files/descriptor.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstdint>
#include <netinet/in.h>
#include <span>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <system_error>

namespace sonopose::test {

/// Sends datagrams to a port of this machine, by default to one that was free a moment ago.
class UdpSender {
public:
  UdpSender() : UdpSender(0) {
    const files::Descriptor probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    require(::bind(probe.number(), reinterpret_cast<const sockaddr*>(&to_), sizeof to_) == 0, "bind");
    socklen_t size = sizeof to_;
    require(::getsockname(probe.number(), reinterpret_cast<sockaddr*>(&to_), &size) == 0, "getsockname");
  }
  /// Makes another sender to the same port.
  explicit UdpSender(const sockaddr_in& to) : to_(to) {}
  /// Makes a sender to a port of this machine.
  explicit UdpSender(std::uint16_t port) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to_.sin_port = htons(port);
  }

  [[nodiscard]] const sockaddr_in& to() const { return to_; }
  [[nodiscard]] std::string endpoint() const { return "127.0.0.1:" + std::to_string(ntohs(to_.sin_port)); }

  /// Throws std::system_error.
  void send(std::span<const std::uint8_t> bytes) const {
    const auto sent = ::sendto(file_.number(), bytes.data(), bytes.size(), 0,
                               reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    require(sent == static_cast<ssize_t>(bytes.size()), "sendto");
  }
  void send(std::string_view text) const {
    send(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
  }

private:
  static void require(bool good, const char* call) {
    if (!good) throw std::system_error(errno, std::generic_category(), call);
  }

  files::Descriptor file_{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  sockaddr_in to_{};
};

}  // namespace sonopose::test
