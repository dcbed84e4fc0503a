#pragma once
/// \file
/// Datagrams to and from one machine.

#include "transport/byte_source.hpp"
#include "transport/udp_listener.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace sonopose::transport {

/// Sends to the peer's endpoint, or to another port of its machine once answer_last_sender() accepts it.
/// read() returns `refused` for the datagrams of other machines.
class UdpPeer : public ByteLink {
public:
  /// `local_port`: 0 lets the system choose. Throws std::invalid_argument for one that
  /// needs rights, files::IoError if it cannot be bound otherwise.
  UdpPeer(const Endpoint& peer, std::uint16_t local_port);
  ~UdpPeer() override;
  UdpPeer(const UdpPeer&) = delete;
  UdpPeer& operator=(const UdpPeer&) = delete;

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override;
  void stop() override;
  void send(std::vector<std::uint8_t> bytes) override;
  void answer_last_sender() override;
  [[nodiscard]] std::uint64_t unsent() const override;
  [[nodiscard]] SendFailures send_failures() const override;
  [[nodiscard]] std::string name() const override;

private:
  class Socket;
  std::unique_ptr<Socket> socket_;
};

}  // namespace sonopose::transport
