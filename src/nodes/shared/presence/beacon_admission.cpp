#include "presence/beacon_admission.hpp"

#include "clocks/clocks.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonopose::presence {

BeaconAdmission::BeaconAdmission(AddressSet addresses, std::size_t max_beacons, Pace pace)
    : addresses_(std::move(addresses)), max_beacons_(max_beacons), pace_(pace) {}

bool BeaconAdmission::accepts(BeaconAddress address) noexcept {
  return has(address) || accepts(address, clocks::steady_now());
}

/// True if the latest new beacons came too fast: `next_` is ahead by all that may come together.
bool BeaconAdmission::is_too_soon(SteadyTime now) const {
  return pace_ == Pace::limited && next_ - now > static_cast<TimeNs>(max_at_once - 1) * spacing_ns;
}

bool BeaconAdmission::accepts(BeaconAddress address, SteadyTime now) noexcept {
  const threads::Lock lock(mutex_);
  if (admitted_[address]) return true;
  if (!addresses_.contains(address)) return false;
  const bool may_be_known = known_[address] || known_.count() < max_replacements * max_beacons_;
  if (admitted_.count() >= max_beacons_ || !may_be_known) {
    refused_[address] = true;
    return false;
  }
  if (is_too_soon(now)) return false;
  next_ = std::max(next_, now) + spacing_ns;
  admitted_[address] = true;
  refused_[address] = false;
  known_[address] = true;
  return true;
}

bool BeaconAdmission::has(BeaconAddress address) noexcept {
  const threads::Lock lock(mutex_);
  return admitted_[address];
}

void BeaconAdmission::forget(BeaconAddress address) noexcept {
  const threads::Lock lock(mutex_);
  admitted_[address] = false;
}

std::optional<std::string> BeaconAdmission::refusals() {
  const threads::Lock lock(mutex_);
  const std::size_t count = refused_.count();
  if (count == 0 || count < 10 * reported_count_) return std::nullopt;
  reported_count_ = count;
  return refusal_text();
}

std::optional<std::string> BeaconAdmission::warning() {
  const threads::Lock lock(mutex_);
  return refused_.none() ? std::nullopt : std::optional(refusal_text());
}

/// Text about refusals.
std::string BeaconAdmission::refusal_text() const {
  return fmt::format("{} ignored: the limit is {} at a time and {} since the start (--max-beacons)",
                     text::count_text(refused_.count(), "address is", "addresses are"),
                     text::count_text(max_beacons_, "beacon"), max_replacements * max_beacons_);
}

}  // namespace sonopose::presence
