#pragma once
/// \file
/// Selection of the beacons that a process handles.

#include <sonopose/samples/samples.hpp>

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace sonopose::presence {

/// Ranges of beacon addresses. A value type.
class AddressSet {
public:
  /// Selects every beacon.
  AddressSet() = default;

  /// Parses "7", "7-131", "7-131,200": numbers from 0 to 65534, ranges from low to high. Throws
  /// std::invalid_argument that names the malformed part.
  static AddressSet parse(std::string_view text);

  [[nodiscard]] bool contains(BeaconAddress address) const {
    if (ranges_.empty()) return true;
    for (const auto& [first, last] : ranges_) {
      if (first <= address && address <= last) return true;
    }
    return false;
  }

  /// First listed address; empty for every beacon.
  [[nodiscard]] std::optional<BeaconAddress> first() const {
    return ranges_.empty() ? std::nullopt : std::optional(ranges_.front().first);
  }
  /// Returns this set extended by one address.
  [[nodiscard]] AddressSet with(BeaconAddress address) const {
    AddressSet more = *this;
    if (!ranges_.empty()) more.ranges_.emplace_back(address, address);
    return more;
  }
  /// True if it is a single beacon, possibly listed several times.
  [[nodiscard]] bool only_one() const;

private:
  std::vector<std::pair<BeaconAddress, BeaconAddress>> ranges_;  ///< empty: every beacon
};

}  // namespace sonopose::presence
