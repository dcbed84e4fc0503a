#pragma once
/// \file
/// A beacon that sends datagrams to this machine.

#include <arpa/inet.h>
#include <cerrno>
#include <cstdint>
#include <netinet/in.h>
#include <span>
#include <string>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::test {

/// Sends datagrams to a port of this machine that was free a moment ago.
class UdpSender {
public:
  UdpSender() : file_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    require(::bind(probe, reinterpret_cast<const sockaddr*>(&to_), sizeof to_) == 0, "bind");
    socklen_t size = sizeof to_;
    require(::getsockname(probe, reinterpret_cast<sockaddr*>(&to_), &size) == 0, "getsockname");
    ::close(probe);
  }
  /// Makes another sender to the same port.
  explicit UdpSender(const sockaddr_in& to)
      : file_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)), to_(to) {}
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;
  UdpSender(UdpSender&&) = delete;
  UdpSender& operator=(UdpSender&&) = delete;
  ~UdpSender() { ::close(file_); }

  [[nodiscard]] const sockaddr_in& to() const { return to_; }
  [[nodiscard]] std::string endpoint() const { return "127.0.0.1:" + std::to_string(ntohs(to_.sin_port)); }

  /// Throws std::system_error.
  void send(std::span<const std::uint8_t> bytes) const {
    const auto sent =
        ::sendto(file_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    require(sent == static_cast<ssize_t>(bytes.size()), "sendto");
  }

private:
  static void require(bool good, const char* call) {
    if (!good) throw std::system_error(errno, std::generic_category(), call);
  }

  int file_;
  sockaddr_in to_{};
};

}  // namespace sonopose::test
