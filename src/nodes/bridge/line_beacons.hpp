#pragma once
/// \file
/// The beacons of a live line. Noise and forged datagrams can contain any address.

#include "presence/beacon_admission.hpp"
#include "presence/beacon_presence.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::bridge {

/// Admits the beacons heard first, a limited number at a time, and finds those that are gone.
class LineBeacons {
public:
  explicit LineBeacons(std::size_t max_beacons) : admission_({}, max_beacons) {}

  /// True if packets of this beacon are to be used.
  bool accepts(std::uint8_t address, SteadyTime now);

  /// Removes and returns the beacons that are gone (presence::BeaconPresence). Others may take their places.
  std::vector<std::uint8_t> remove_gone(SteadyTime now);

  /// See presence::BeaconAdmission::refusals.
  std::optional<std::string> refusals() { return admission_.refusals(); }

private:
  presence::BeaconAdmission admission_;
  std::map<std::uint8_t, presence::BeaconPresence> presences_;
};

}  // namespace sonopose::bridge
