#include "fusion/beacon_estimators.hpp"

#include <sonopose/settings/preset.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

namespace sonopose::fusion {

BeaconEstimators::BeaconEstimators(const config::FusionConfig& config, bool lossless)
    : lossless_(lossless), default_timeline_(config.beacon(all_beacons)) {
  for (const BeaconAddress address : config.beacons()) timelines_.emplace(address, config.beacon(address));
}

BeaconEstimators::Beacon::Beacon(SettingsTimeline& settings, bool lossless)
    : timeline(settings), estimator(settings.settings()) {
  if (lossless) collator.emplace<collation::LosslessCollator>();
}

const collation::CollatorCounters& BeaconEstimators::Beacon::order_counters() const {
  return std::visit(
      [](const auto& of_kind) -> const auto& { return of_kind.counters(); }, collator);
}

BeaconEstimators::Beacon& BeaconEstimators::beacon_of(BeaconAddress address) {
  auto& beacon = beacons_[address];
  if (!beacon) beacon = std::make_unique<Beacon>(timeline_of(address), lossless_);
  return *beacon;
}

SettingsTimeline& BeaconEstimators::timeline_of(BeaconAddress address) {
  return timelines_.try_emplace(address, default_timeline_).first->second;
}

std::span<const collation::CollatedEvent> BeaconEstimators::collate(const Event& event, SteadyTime now) {
  auto& collator = beacon_of(address_of(event)).collator;
  if (auto* live = std::get_if<collation::Collator>(&collator)) return live->push(event, now);
  return std::get<collation::LosslessCollator>(collator).push(event);
}

EventOutcome BeaconEstimators::process(const collation::CollatedEvent& collated) noexcept {
  const auto& [event, restart] = collated;
  Beacon& beacon = *beacons_.find(address_of(event))->second;
  // A restarted bridge that plays an older recording.
  if (restart && available_at_ns(event) < beacon.estimator.time_ns()) beacon.estimator.reset();

  EventOutcome outcome;
  const std::uint64_t sequence = sequence_of(event);
  const bool first = !beacon.last_sequence;
  const bool changed = beacon.timeline.advance(sequence);
  beacon.last_sequence = sequence;
  if (changed) beacon.estimator.configure(beacon.timeline.settings());
  if (first || changed) {
    outcome.settings = SettingsChange{address_of(event), sequence, beacon.estimator.settings()};
  }
  outcome.result = estimation::process(beacon.estimator, event);
  const auto* report = std::get_if<FixReport>(&outcome.result);
  if (report != nullptr) {
    if ((report->flags & fix_too_late) != 0) ++beacon.fixes_late;
    beacon.refusals.on(*report);
  }
  return outcome;
}

void BeaconEstimators::catch_up(BeaconAddress address) noexcept {
  const auto found = beacons_.find(address);
  if (found != beacons_.end()) found->second->estimator.catch_up();
}

void BeaconEstimators::reset(BeaconAddress address) {
  for (auto& [known, beacon] : beacons_) {
    if (known == address || address == all_beacons) beacon->estimator.reset();
  }
}

SettingsReply BeaconEstimators::change_settings(const SettingsRequest& request) {
  constexpr std::size_t remembered = 64;  // more than can be pending
  const auto is_repeated = [&request](const SettingsReply& reply) {
    return request.request_id != 0 && reply.request_id == request.request_id &&
           reply.address == request.address;
  };
  const auto found = std::find_if(replies_.begin(), replies_.end(), is_repeated);
  if (found != replies_.end()) return *found;

  SettingsReply reply{.address = request.address, .request_id = request.request_id, .reason = {}};
  try {
    carry_out(request, reply);
    reply.accepted = true;
  } catch (const settings::SettingError& error) {
    reply.reason = error.what();
    reply.from_sequence = 0;
  }
  if (replies_.size() == remembered) replies_.pop_front();
  replies_.push_back(reply);
  return reply;
}

/// Throws SettingError before it changes anything.
void BeaconEstimators::carry_out(const SettingsRequest& request, SettingsReply& reply) {
  if (request.assignments.empty()) throw settings::SettingError("the request has no assignments");
  const config::Assignments assignments = config::parsed(request.assignments);
  const std::uint64_t from = request.from_sequence;
  reply.from_sequence = from;
  settings::Settings after;
  if (request.address == all_beacons) {
    for (const auto& [address, timeline] : timelines_) {
      check_capacity(timeline, address, from);
      check_possible(timeline, fmt::format("beacon {}: ", address), ahead(address, from),
                     SettingsTimeline::Scope::for_all, assignments);
    }
    check_possible(default_timeline_, "", from, SettingsTimeline::Scope::for_all, assignments);
    for (auto& [address, timeline] : timelines_) {
      timeline.add(ahead(address, from), SettingsTimeline::Scope::for_all, assignments);
    }
    default_timeline_.add(from, SettingsTimeline::Scope::for_all, assignments);
    after = default_timeline_.settings_at(from);
    reply.details = first_events(from);
  } else {
    SettingsTimeline& timeline = timeline_of(request.address);
    check_capacity(timeline, request.address, from);
    check_possible(timeline, "", ahead(request.address, from), SettingsTimeline::Scope::own, assignments);
    timeline.add(ahead(request.address, from), SettingsTimeline::Scope::own, assignments);
    after = timeline.settings_at(from);
    if (const auto last = last_sequence(request.address)) reply.from_sequence = std::max(from, *last + 1);
  }
  std::vector<std::string> remarks = config::warnings_for(after, assignments);
  if (assignments.contains("fusion.engine")) {
    remarks.emplace_back("where fusion.engine changes, the estimate starts again and reset_counter rises");
  }
  reply.reason = fmt::format("{}", fmt::join(remarks, "; "));
}

SettingsChange BeaconEstimators::settings_for_all() const {
  constexpr auto end = std::numeric_limits<std::uint64_t>::max();
  return {all_beacons, default_timeline_.last_from_sequence(),
          settings::resolved(default_timeline_.settings_at(end))};
}

std::optional<std::uint64_t> BeaconEstimators::last_sequence(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  return found == beacons_.end() ? std::nullopt : found->second->last_sequence;
}

std::string BeaconEstimators::first_events(std::uint64_t from_sequence) const {
  std::vector<std::string> texts;
  for (const auto& entry : timelines_) {  // in the order of the addresses
    const auto last = last_sequence(entry.first);
    if (last) texts.push_back(fmt::format("{}: event {}", entry.first, std::max(from_sequence, *last + 1)));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::uint64_t BeaconEstimators::ahead(BeaconAddress address, std::uint64_t sequence) const {
  const auto last = last_sequence(address);
  return last && sequence <= *last ? 0 : sequence;
}

void BeaconEstimators::check_capacity(const SettingsTimeline& timeline, BeaconAddress address,
                                      std::uint64_t from_sequence) const {
  if (timeline.can_add(ahead(address, from_sequence))) return;
  throw settings::SettingError(fmt::format("beacon {}: already {} changes wait for their events", address,
                                           SettingsTimeline::capacity));
}

/// Throws SettingError if no estimator could work with the settings that this change leads to.
void BeaconEstimators::check_possible(SettingsTimeline timeline, const std::string& whose,
                                      std::uint64_t from_sequence, SettingsTimeline::Scope scope,
                                      const config::Assignments& assignments) {
  timeline.add(from_sequence, scope, assignments);
  timeline.for_each_from(from_sequence, [&whose](const settings::Settings& settings) {
    const std::string fault = config::fault_of(settings);
    if (!fault.empty()) throw settings::SettingError(whose + fault);
  });
}

std::optional<FusionStatus> BeaconEstimators::status(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  if (found == beacons_.end()) return std::nullopt;
  const Beacon& beacon = *found->second;
  const EstimatorCounters& counted = beacon.estimator.counters();
  const collation::CollatorCounters& order = beacon.order_counters();
  FusionStatus status;
  status.address = address;
  status.imu_samples = counted.imu_samples;
  status.fixes_used = counted.fixes_used;
  status.fixes_rejected = counted.fixes_rejected;
  status.fixes_late = beacon.fixes_late;
  status.headings = counted.headings;
  status.events_lost = order.lost;
  status.events_duplicated = order.duplicated;
  status.samples_invalid = counted.samples_invalid;
  status.imu_gaps = counted.imu_gaps;
  status.reset_counter = beacon.estimator.reset_counter();
  return status;
}

std::optional<std::string> BeaconEstimators::fix_refusals(BeaconAddress address, SteadyTime now) {
  const auto found = beacons_.find(address);
  if (found == beacons_.end()) return std::nullopt;
  return found->second->refusals.update(now);
}

std::optional<Estimate> BeaconEstimators::estimate(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  if (found == beacons_.end()) return std::nullopt;
  Estimate estimate = found->second->estimator.estimate();
  estimate.address = address;
  return estimate;
}

std::optional<collation::LosslessCollator::Gap> BeaconEstimators::gap(BeaconAddress address) const {
  const auto found = beacons_.find(address);
  if (found == beacons_.end()) return std::nullopt;
  const auto* collator = std::get_if<collation::LosslessCollator>(&found->second->collator);
  return collator == nullptr ? std::nullopt : collator->gap();
}

std::vector<BeaconAddress> BeaconEstimators::addresses() const {
  std::vector<BeaconAddress> addresses;
  addresses.reserve(beacons_.size());
  for (const auto& entry : beacons_) addresses.push_back(entry.first);
  return addresses;
}

}  // namespace sonopose::fusion
