#pragma once
/// \file
/// Keeps the packets of another sender out of the stream of a beacon. UDP senders can claim any address.

#include "transport/byte_source.hpp"
#include <sonopose/samples/samples.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace sonopose::bridge {

/// A beacon's address belongs to its first sender until that has been silent for a while.
class AddressOwners {
public:
  /// How long the owner must be silent before another sender can take over, such as a modem that restarted.
  static constexpr TimeNs release_ns = 3'000'000'000;

  /// Whether a packet of this beacon from `sender` is to be used. Logs the first one that is not.
  bool accepts(std::uint8_t address, const transport::Sender& sender, SteadyTime now);

private:
  struct Owner {
    bool exists = false;
    bool reported = false;  ///< that another sender uses its address
    transport::Sender sender;
    SteadyTime heard;
  };

  static constexpr std::size_t addresses = 256;  ///< on the wire
  std::array<Owner, addresses> owners_{};
};

}  // namespace sonopose::bridge
