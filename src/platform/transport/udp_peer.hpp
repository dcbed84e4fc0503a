#pragma once
/// \file
/// Datagrams to and from one machine.

#include "transport/byte_source.hpp"
#include "transport/udp_listener.hpp"

#include <cstdint>
#include <memory>

namespace sonopose::transport {

/// Makes a link that sends to the peer's endpoint, or to another port of its machine once
/// answer_last_sender() accepts it. read() returns `refused` for the datagrams of other machines, and the
/// port of the others.
/// `local_port`: 0 lets the system choose. Throws std::invalid_argument for one that needs rights,
/// files::IoError if it cannot be bound otherwise.
std::unique_ptr<ByteLink> open_udp_peer(const Endpoint& peer, std::uint16_t local_port);

}  // namespace sonopose::transport
