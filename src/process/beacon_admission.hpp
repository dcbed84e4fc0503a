#pragma once
/// \file
/// Bounds the number of beacons of a process.

#include "process/address_set.hpp"
#include <sonopose/dds/topics/topics.hpp>

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <string>

namespace sonopose::process {

/// Admits the beacons that are heard first. Thread-safe.
class BeaconAdmission final : public dds::topics::AddressFilter {
public:
  static constexpr std::size_t default_max_beacons = 256;
  /// How many times the limit of beacons may come and go, so that a stream of invented addresses ends.
  static constexpr std::size_t most_replacements = 16;

  /// `addresses`: the only ones that may be admitted.
  BeaconAdmission(AddressSet addresses, std::size_t max_beacons);

  /// Whether the beacon is admitted, or can be and now is. Does not allocate.
  bool accepts(BeaconAddress address) noexcept override;

  /// Whether the beacon is admitted now.
  [[nodiscard]] bool has(BeaconAddress address) noexcept;

  /// A beacon is gone: another one may take its place.
  void forget(BeaconAddress address) noexcept;

  /// A message for the user, once a beacon was refused and when another ten times as many were. Empty
  /// otherwise. Call it once a second.
  std::optional<std::string> refusals();

  /// A message for the user if there are beacons that were refused and have not been admitted since.
  std::optional<std::string> warning();

private:
  [[nodiscard]] std::string refusal_text() const;

  static constexpr std::size_t addresses_ever = std::size_t{std::numeric_limits<BeaconAddress>::max()} + 1;
  using Flags = std::bitset<addresses_ever>;

  AddressSet addresses_;
  std::size_t max_beacons_;
  std::mutex mutex_;  // guards the rest
  Flags admitted_;
  Flags known_;  ///< were admitted once: DDS keeps an instance of each until its writers have ended
  Flags refused_;
  std::size_t reported_count_ = 0;
};

/// Accepts the beacons that another topic has admitted, for topics without measurements.
class AdmittedOnly final : public dds::topics::AddressFilter {
public:
  /// `admission` must outlive it.
  explicit AdmittedOnly(BeaconAdmission& admission) : admission_(admission) {}
  bool accepts(BeaconAddress address) noexcept override { return admission_.has(address); }

private:
  BeaconAdmission& admission_;
};

}  // namespace sonopose::process
