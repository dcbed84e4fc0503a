#pragma once
/// \file
/// Keeps packets of another sender out of a beacon's stream. UDP senders can claim any address.

#include "transport/byte_source.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace sonopose::bridge {

/// Binds a beacon's address, and the map of the stationary beacons, to their first sender until that sender
/// has been silent for a while.
class AddressOwners {
public:
  /// Silence of the owner after which another sender, such as a restarted modem, may take over.
  static constexpr TimeNs release_ns = 3'000'000'000;

  /// True if a packet of this beacon, or without an address a map, from `sender` is to be used. Logs the
  /// first one that is not. Between its maps, which are ten seconds apart, a sender keeps the map by other
  /// packets.
  bool accepts(std::optional<std::uint8_t> address, const transport::Sender& sender, SteadyTime now);

private:
  struct Owner {
    bool exists = false;
    bool reported = false;  ///< the use by another sender was logged
    transport::Sender sender;
    SteadyTime heard;
  };

  static constexpr std::size_t addresses = 256;  ///< all that a packet can name
  std::array<Owner, addresses> owners_{};
  Owner map_owner_{};
};

}  // namespace sonopose::bridge
