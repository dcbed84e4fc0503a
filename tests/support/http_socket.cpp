#include "support/http_socket.hpp"

#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <array>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

namespace sonopose::test {

HttpSocket::HttpSocket(std::uint16_t port, int receive_buffer_bytes)
    : descriptor_(::socket(AF_INET, SOCK_STREAM, 0)) {
  if (receive_buffer_bytes > 0) {
    ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof receive_buffer_bytes);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
}

HttpSocket::~HttpSocket() {
  ::close(descriptor_);
}

void HttpSocket::send(const std::string& text) const {
  REQUIRE(::send(descriptor_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()));
}

std::string HttpSocket::read_until(const std::string& end) {
  while (received_.find(end) == std::string::npos && read_some()) {
  }
  const std::size_t found = received_.find(end);
  std::string text = received_.substr(0, found == std::string::npos ? found : found + end.size());
  received_.erase(0, text.size());
  return text;
}

std::string HttpSocket::read_all() {
  while (read_some()) {
  }
  CHECK(is_closed_);
  return std::exchange(received_, {});
}

std::string HttpSocket::read_message() {
  const auto need = [this](std::size_t bytes) {
    while (received_.size() < bytes) REQUIRE(read_some());
  };
  const auto byte = [this](std::size_t i) { return static_cast<unsigned char>(received_[i]); };
  need(2);
  std::size_t header = 2;
  std::size_t size = byte(1);
  const std::size_t further = size == 126 ? 2 : size == 127 ? 8 : 0;
  if (further > 0) {
    need(2 + further);
    size = 0;
    for (std::size_t i = 0; i < further; ++i) size = 256 * size + byte(2 + i);
    header += further;
  }
  need(header + size);
  std::string payload = received_.substr(header, size);
  const auto operation = byte(0) & 0x0FU;
  received_.erase(0, header + size);
  constexpr unsigned ping = 9;
  if (operation != ping) return payload;
  send({"\x8a\x80\0\0\0\0", 6});  // pong
  return read_message();
}

void HttpSocket::send_message(const std::string& text) const {
  std::string frame{'\x81'};
  if (text.size() < 126) {
    frame += static_cast<char>(0x80U | text.size());
  } else {
    frame += static_cast<char>(0x80U | 127U);
    for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>((text.size() >> shift) & 0xFFU);
  }
  send(frame + std::string(4, '\0') + text);
}

bool HttpSocket::read_some() {
  pollfd waiting{.fd = descriptor_, .events = POLLIN, .revents = 0};
  constexpr int timeout_ms = 180'000;  // reached only by a failing test
  if (::poll(&waiting, 1, timeout_ms) <= 0) return false;
  std::array<char, 65536> buffer{};
  const ssize_t count = ::recv(descriptor_, buffer.data(), buffer.size(), 0);
  is_closed_ = count <= 0;
  if (count > 0) received_.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

}  // namespace sonopose::test
