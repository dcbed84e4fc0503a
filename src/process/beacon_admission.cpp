#include "process/beacon_admission.hpp"

#include <fmt/format.h>

#include <utility>

namespace sonopose::process {

namespace {

/// How many times the limit of beacons may come and go, so that a stream of invented addresses ends.
constexpr std::size_t most_replacements = 16;

}  // namespace

BeaconAdmission::BeaconAdmission(AddressSet addresses, std::size_t max_beacons)
    : addresses_(std::move(addresses)), max_beacons_(max_beacons) {}

bool BeaconAdmission::accepts(BeaconAddress address) noexcept {
  if (!addresses_.contains(address)) return false;
  const std::lock_guard lock(mutex_);
  if (admitted_[address]) return true;
  const bool is_new = !known_[address];
  if (admitted_count_ >= max_beacons_ || (is_new && known_count_ >= most_replacements * max_beacons_)) {
    if (!refused_[address]) ++refused_count_;
    refused_[address] = true;
    return false;
  }
  admitted_[address] = true;
  ++admitted_count_;
  if (is_new) ++known_count_;
  known_[address] = true;
  return true;
}

void BeaconAdmission::forget(BeaconAddress address) noexcept {
  const std::lock_guard lock(mutex_);
  if (admitted_[address]) --admitted_count_;
  admitted_[address] = false;
}

std::optional<std::string> BeaconAdmission::refusals() {
  const std::lock_guard lock(mutex_);
  if (refused_count_ == 0 || refused_count_ < 10 * reported_count_) return std::nullopt;
  reported_count_ = refused_count_;
  return fmt::format("{} addresses are ignored: more than {} beacons (--max-beacons)", refused_count_,
                     max_beacons_);
}

}  // namespace sonopose::process
