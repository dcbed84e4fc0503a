#pragma once
/// \file
/// A service manager's end of sd_notify(3).

#include <cstring>
#include <filesystem>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::test {

class NotifySocket {
public:
  explicit NotifySocket(const std::filesystem::path& path) : socket_(::socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::system_error(errno, std::generic_category(), "bind " + path.string());
    }
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;
  ~NotifySocket() { ::close(socket_); }

  /// Returns the next message; empty if none arrives within the limit.
  std::string next(int limit_ms) {
    pollfd event{socket_, POLLIN, 0};
    if (::poll(&event, 1, limit_ms) <= 0) return {};
    std::string text(4096, '\0');
    const auto size = ::recv(socket_, text.data(), text.size(), 0);
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
  }

  /// Skips messages until one has this text. Returns it; empty if the limit of one expires first.
  std::string next_with(const std::string& wanted) {
    constexpr int limit_ms = 60'000;
    for (std::string text = next(limit_ms); !text.empty(); text = next(limit_ms)) {
      if (text.find(wanted) != std::string::npos) return text;
    }
    return {};
  }

private:
  int socket_;
};

}  // namespace sonopose::test
