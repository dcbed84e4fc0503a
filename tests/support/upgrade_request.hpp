#pragma once
/// \file
/// Upgrade request of a WebSocket client.

#include <string>

namespace sonopose::test {

/// Requests a WebSocket. `headers` are further lines, each with its line end.
inline std::string upgrade_request(const std::string& target, const std::string& protocols,
                                   const std::string& headers) {
  return "GET " + target + " HTTP/1.1\r\n" + headers +
         "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
         protocols + "\r\n\r\n";
}

}  // namespace sonopose::test
