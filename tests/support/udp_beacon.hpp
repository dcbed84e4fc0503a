#pragma once
/// \file
/// Datagrams of a beacon to a program on this machine.

#include "support/beacon_bytes.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <cerrno>
#include <cstdint>
#include <netinet/in.h>
#include <span>
#include <string>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace sonopose::test {

/// Sends datagrams to a port of this machine that was recently free.
class UdpSender {
public:
  UdpSender() : file_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    REQUIRE(::bind(probe, reinterpret_cast<const sockaddr*>(&to_), sizeof to_) == 0);
    socklen_t size = sizeof to_;
    REQUIRE(::getsockname(probe, reinterpret_cast<sockaddr*>(&to_), &size) == 0);
    ::close(probe);
  }
  /// Another sender to the same port.
  explicit UdpSender(const sockaddr_in& to)
      : file_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)), to_(to) {}
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;
  UdpSender(UdpSender&&) = delete;
  UdpSender& operator=(UdpSender&&) = delete;
  ~UdpSender() { ::close(file_); }

  [[nodiscard]] const sockaddr_in& to() const { return to_; }
  [[nodiscard]] std::string endpoint() const { return "127.0.0.1:" + std::to_string(ntohs(to_.sin_port)); }

  /// Throws std::system_error. Several threads may send, so this is no assertion.
  void send(std::span<const std::uint8_t> bytes) const {
    const auto sent =
        ::sendto(file_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    if (sent < 0) throw std::system_error(errno, std::generic_category(), "sendto");
  }

private:
  int file_;
  sockaddr_in to_{};
};

/// What a beacon sends at rest.
inline std::vector<TimedFrame> resting_beacon(const Bus& bus, BeaconAddress address, int duration_s) {
  const TemporaryFolder folder;
  const std::string file = (folder / "bytes.bin").string();
  REQUIRE(bus.bridge({"--scenario", "rest", "--rate", "0", "--duration", std::to_string(duration_s),
                      "--capture", file, "--address", std::to_string(address)})
              ->wait_for_exit() == 0);
  return timed_datagrams(read_bytes(file));
}

}  // namespace sonopose::test
