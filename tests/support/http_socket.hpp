#pragma once
/// \file
/// An HTTP and WebSocket client that reads and writes byte by byte.

#include "support/upgrade_request.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

namespace sonopose::test {

/// A connection to a port of this machine. Fails the test if it cannot connect, send, or read within 3
/// minutes.
class HttpSocket {
public:
  explicit HttpSocket(std::uint16_t port, int receive_buffer_bytes = 0);
  HttpSocket(const HttpSocket&) = delete;
  HttpSocket& operator=(const HttpSocket&) = delete;
  ~HttpSocket();

  void send(const std::string& text) const;

  /// Reads until `end`, the end of the connection, or 3 minutes without a byte.
  std::string read_until(const std::string& end);
  /// Reads until the server closes; fails the test if it does not.
  std::string read_all();

  /// Payload of the server's next WebSocket message. Answers and skips pings.
  std::string read_message();
  /// Sends a text message, masked with zeros.
  void send_message(const std::string& text) const;

private:
  bool read_some();

  int descriptor_;
  std::string received_;
  bool is_closed_ = false;
};

}  // namespace sonopose::test
