#pragma once
/// \file
/// Datagrams of a beacon to a program on this machine.

#include "support/beacon_bytes.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/udp_sender.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace sonopose::test {

/// Datagrams of a resting beacon.
inline std::vector<TimedFrame> resting_beacon(const Bus& bus, BeaconAddress address, int duration_s) {
  const TemporaryFolder folder;
  const std::string file = (folder / "bytes.bin").string();
  REQUIRE(bus.bridge({"--scenario", "rest", "--rate", "0", "--duration", std::to_string(duration_s),
                      "--capture", file, "--address", std::to_string(address)})
              ->wait_for_exit() == 0);
  return timed_datagrams(read_bytes(file));
}

}  // namespace sonopose::test
