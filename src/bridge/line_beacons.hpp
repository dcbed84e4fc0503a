#pragma once
/// \file
/// The beacons of a live line. Noise and forged datagrams can contain any address.

#include "process/beacon_admission.hpp"
#include "process/heard.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::bridge {

/// Admits at most so many beacons at a time, the first ones that are heard, and finds those that are gone.
class LineBeacons {
public:
  explicit LineBeacons(std::size_t max_beacons) : admission_({}, max_beacons) {}

  /// Whether a packet of this beacon is to be used.
  bool accepts(std::uint8_t address, SteadyTime now);

  /// Removes and returns the beacons that are gone (see process::Heard); others may take their places.
  std::vector<std::uint8_t> remove_gone(SteadyTime now);

  /// See process::BeaconAdmission::refusals.
  std::optional<std::string> refusals() { return admission_.refusals(); }

private:
  process::BeaconAdmission admission_;
  std::map<std::uint8_t, process::Heard> heard_;
};

}  // namespace sonopose::bridge
