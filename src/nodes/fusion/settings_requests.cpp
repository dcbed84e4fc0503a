#include "fusion/settings_requests.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::fusion {
namespace {

using Scope = SettingsTimeline::Scope;
using Schedule = BeaconEstimators::Schedule;

/// First event of a beacon that a change can still apply to.
std::uint64_t first_event(const Schedule& schedule, std::uint64_t from_sequence) {
  return schedule.last_sequence ? std::max(from_sequence, *schedule.last_sequence + 1) : from_sequence;
}

/// Adds the change to a copy of the schedule of one beacon, or of beacons that appear later. Throws
/// SettingError if there is no space, or if no estimator could work with the resulting settings.
void add(const SettingsRequest& request, const config::Assignments& assignments, BeaconAddress address,
         Schedule& schedule) {
  auto& [timeline, last] = schedule;
  const std::uint64_t from = last && request.from_sequence <= *last ? 0 : request.from_sequence;
  if (!timeline.can_add(from)) {
    throw settings::SettingError(fmt::format("beacon {}: already {} changes wait for their events", address,
                                             SettingsTimeline::capacity));
  }
  timeline.add(from, request.address == all_beacons ? Scope::for_all : Scope::own, assignments);
  timeline.for_each_from(from, [&](const settings::Settings& settings) {
    const std::string fault = config::fault_of(settings);
    if (fault.empty()) return;
    const bool is_one_of_many = request.address == all_beacons && address != all_beacons;
    throw settings::SettingError((is_one_of_many ? fmt::format("beacon {}: ", address) : "") + fault);
  });
}

/// The effect of a request on the beacons with a schedule.
class Effect {
public:
  explicit Effect(const SettingsRequest& request) : from_sequence_(request.from_sequence) {}

  /// Adds one beacon, with the request in its schedule.
  void add(BeaconAddress address, const Schedule& schedule, const config::Assignments& assignments) {
    const settings::Settings& after = schedule.timeline.settings_at(from_sequence_);
    std::size_t kept = 0;
    for (const auto& [key, value] : assignments) {
      const settings::SettingValue own = settings::get(after, key);
      if (own == value) continue;
      kept_[key].push_back(fmt::format("{} ({})", address, settings::to_text(own)));
      ++kept;
    }
    if (!schedule.last_sequence) return;  // not received yet
    if (kept == assignments.size()) {
      unchanged_.push_back(address);
    } else {
      events_.push_back(fmt::format("{}: event {}", address, first_event(schedule, from_sequence_)));
    }
  }

  /// Value of SettingsReply::details.
  [[nodiscard]] std::string details() const {
    std::string text = fmt::format("{}", fmt::join(events_, ", "));
    if (unchanged_.empty()) return text;
    return fmt::format("{}{}unchanged: {}", text, text.empty() ? "" : "; ", fmt::join(unchanged_, ", "));
  }

  /// One text for each setting with beacons that keep their own value.
  [[nodiscard]] std::vector<std::string> remarks() const {
    std::vector<std::string> texts;
    for (const auto& [key, beacons] : kept_) {
      texts.push_back(
          fmt::format("{} stays as it is for beacon {}: a value of its own, which only a request for that "
                      "beacon changes",
                      key, fmt::join(beacons, ", ")));
    }
    return texts;
  }

private:
  std::uint64_t from_sequence_;
  std::vector<std::string> events_;
  std::vector<BeaconAddress> unchanged_;                  ///< keep their own values of all the settings
  std::map<std::string, std::vector<std::string>> kept_;  ///< by key, beacons with the value that stays
};

}  // namespace

SettingsReply SettingsRequests::answer(const SettingsRequest& request) {
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
  } catch (const std::exception& error) {
    reply.reason = error.what();
    reply.from_sequence = 0;
    reply.details.clear();
  }
  if (replies_.size() == remembered) replies_.pop_front();
  replies_.push_back(reply);
  return reply;
}

/// Carries out a request. Throws before it changes anything.
void SettingsRequests::carry_out(const SettingsRequest& request, SettingsReply& reply) {
  if (request.assignments.empty()) throw settings::SettingError("the request has no assignments");
  const config::Assignments assignments = config::parsed(request.assignments);
  const bool is_for_all = request.address == all_beacons;

  auto addresses = estimators_.with([](auto& estimators) { return estimators.scheduled(); });
  constexpr std::size_t max_scheduled = 1024;
  if (!is_for_all && addresses.size() >= max_scheduled &&
      !std::binary_search(addresses.begin(), addresses.end(), request.address)) {
    throw settings::SettingError(fmt::format("already {} beacons have settings", max_scheduled));
  }
  if (!is_for_all) addresses.clear();
  addresses.push_back(request.address);
  std::vector<Schedule> schedules;
  Effect effect(request);
  for (const BeaconAddress address : addresses) {
    schedules.push_back(
        estimators_.with([address](auto& estimators) { return estimators.schedule(address); }));
    add(request, assignments, address, schedules.back());
    if (address != request.address) effect.add(address, schedules.back(), assignments);
  }
  const settings::Settings after = schedules.back().timeline.settings_at(request.from_sequence);
  reply.from_sequence = first_event(schedules.back(), request.from_sequence);
  reply.details = effect.details();
  std::map<BeaconAddress, settings::Settings> own;  // without the requested address, which is last
  for (std::size_t i = 0; i + 1 < addresses.size(); ++i) {
    own.emplace(addresses[i], schedules[i].timeline.settings_at(request.from_sequence));
  }
  std::vector<std::string> remarks = effect.remarks();
  for (std::string& text : config::warnings_for_all(after, assignments, own)) {
    remarks.push_back(std::move(text));
  }
  if (assignments.contains("fusion.engine")) {
    remarks.emplace_back("where fusion.engine changes, the estimate restarts and reset_counter rises");
  }
  reply.reason = fmt::format("{}", fmt::join(remarks, "; "));

  estimators_.with([&](auto& estimators) {
    if (is_for_all) {
      estimators.for_each([&](BeaconAddress address, BeaconEstimator& estimator) {
        if (std::binary_search(addresses.begin(), addresses.end(), address)) return;
        SettingsTimeline timeline = schedules.back().timeline;  // appeared since the copies were made
        estimator.exchange_timeline(timeline);
      });
    }
    for (std::size_t i = 0; i < addresses.size(); ++i) {
      estimators.exchange_timeline(addresses[i], schedules[i].timeline);
    }
  });
}

}  // namespace sonopose::fusion
