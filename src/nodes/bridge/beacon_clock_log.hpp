#pragma once
/// \file
/// Describes steps of the beacons' clocks, and stamps that cannot be used.

#include "marvelmind/assembler.hpp"
#include "marvelmind/clock_set.hpp"
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::bridge {

/// A sentence about samples that are left out since they are stamped in the year 2100 or later; empty if
/// there is none.
std::optional<std::string> stamps_too_late_text(const marvelmind::BeaconAssembler& beacon);

/// Reports what is new about the clocks of the beacons.
class BeaconClockLog {
public:
  explicit BeaconClockLog(marvelmind::TimeMapping mapping) : mapping_(mapping) {}

  /// A line for each beacon whose clock stepped since the last call. On a live line also one, once, for each
  /// beacon with stamps of the year 2100 or later; the source of a file ends with that error.
  std::vector<std::string> update(const marvelmind::Assembler& assembler);

private:
  struct Reported {
    std::uint64_t steps = 0;
    bool has_late_stamps = false;
  };
  marvelmind::TimeMapping mapping_;
  std::map<BeaconAddress, Reported> reported_;
};

}  // namespace sonopose::bridge
