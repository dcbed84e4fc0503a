#pragma once
/// \file
/// Keeps packets of another sender out of a beacon's stream. UDP senders can claim any address.

#include "transport/byte_source.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace sonopose::bridge {

/// Binds a beacon's address to its first sender until that sender has been silent for a while.
class AddressOwners {
public:
  /// Silence of the owner after which another sender, such as a restarted modem, may take over.
  static constexpr TimeNs release_ns = 3'000'000'000;

  /// True if a packet of this beacon from `sender` is to be used. Logs the first one that is not.
  bool accepts(std::uint8_t address, const transport::Sender& sender, SteadyTime now);

private:
  struct Owner {
    bool exists = false;
    bool reported = false;  ///< use of its address by another sender was logged
    transport::Sender sender;
    SteadyTime heard;
  };

  static constexpr std::size_t addresses = 256;  ///< all that a packet can name
  std::array<Owner, addresses> owners_{};
};

}  // namespace sonopose::bridge
