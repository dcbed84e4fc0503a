#pragma once
/// \file
/// Bounds the number of beacons of a process.

#include "presence/address_set.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/time.hpp>

#include <bitset>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

namespace sonopose::presence {

/// Admits the beacons heard first. Thread-safe.
class BeaconAdmission final : public dds::topics::AddressFilter {
public:
  static constexpr std::size_t default_max_beacons = 256;
  /// Largest number of replacements per place. Bounds a flood of forged addresses.
  static constexpr std::size_t max_replacements = 16;

  /// Pace of new beacons. Limited: the samples of others are ignored meanwhile, so that a flood of new
  /// addresses does not delay the beacons that are served.
  enum class Pace : bool { unlimited, limited };
  static constexpr std::size_t max_at_once = 16;
  static constexpr TimeNs spacing_ns = 5'000'000;  ///< time for one more new beacon

  /// `addresses`: the only ones to admit.
  BeaconAdmission(AddressSet addresses, std::size_t max_beacons, Pace pace = Pace::unlimited);

  /// True if the beacon is admitted, possibly by this call. Does not allocate.
  bool accepts(BeaconAddress address) noexcept override;
  bool accepts(BeaconAddress address, SteadyTime now) noexcept;

  /// True if the beacon is admitted.
  [[nodiscard]] bool has(BeaconAddress address) noexcept;

  /// Frees the place of a beacon that is gone.
  void forget(BeaconAddress address) noexcept;

  /// A message for the user when the first beacon is refused, and each time ten times as many are. Otherwise
  /// empty. Call it once a second.
  std::optional<std::string> refusals();

  /// A message for the user if beacons were refused and not admitted since.
  std::optional<std::string> warning();

private:
  [[nodiscard]] bool is_too_soon(SteadyTime now) const SONOPOSE_REQUIRES(mutex_);
  [[nodiscard]] std::string refusal_text() const SONOPOSE_REQUIRES(mutex_);

  static constexpr std::size_t addresses_ever = std::size_t{std::numeric_limits<BeaconAddress>::max()} + 1;
  using Flags = std::bitset<addresses_ever>;

  AddressSet addresses_;
  std::size_t max_beacons_;
  Pace pace_;
  threads::Mutex mutex_;
  SteadyTime next_ SONOPOSE_GUARDED_BY(mutex_);  ///< time of the next new beacon at an even pace
  Flags admitted_ SONOPOSE_GUARDED_BY(mutex_);
  /// Ever admitted: DDS keeps an instance of each until its writers have ended.
  Flags known_ SONOPOSE_GUARDED_BY(mutex_);
  Flags refused_ SONOPOSE_GUARDED_BY(mutex_);
  std::size_t reported_count_ SONOPOSE_GUARDED_BY(mutex_) = 0;
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

}  // namespace sonopose::presence
