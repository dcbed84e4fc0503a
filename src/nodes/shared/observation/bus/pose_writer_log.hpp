#pragma once
/// \file
/// Logs whose poses are received, and processes that should not write poses.

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "observation/pose_writers.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::observation::bus {

/// Checks the processes that write poses. Logs new owners of a beacon's poses, and new problems. A problem
/// counts once two consecutive checks find it, because a process starts and ends in parts, and is logged
/// again every minute.
class PoseWriterLog {
public:
  explicit PoseWriterLog(const dds::domain::DomainParticipant& participant) : discovery_(participant) {}

  void log(const ServedBeacons& served) {
    constexpr TimeNs repeat_after_ns = 60'000'000'000;
    const SteadyTime now = clocks::steady_now();
    const auto writers = pose_writers_of(discovery_.writers(), discovery_.participants(), served, now);
    log_owners(writers);
    std::vector<std::string> seen;
    std::vector<std::string> confirmed;
    for (const auto& problem : problems_of(writers)) {
      seen.push_back(problem.what);
      if (contains(seen_, problem.what)) confirmed.push_back(problem.what);
    }
    std::erase_if(logged_, [&](const auto& entry) { return !contains(confirmed, entry.first); });
    for (const std::string& text : confirmed) {
      const auto [logged, is_new] = logged_.try_emplace(text, now);
      if (!is_new && now - logged->second < repeat_after_ns) continue;
      logged->second = now;
      logging::warning(text);
    }
    seen_ = std::move(seen);
    warnings_ = std::move(confirmed);
  }

  /// Problems at the last check.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

private:
  static bool contains(const std::vector<std::string>& list, const std::string& text) {
    return std::find(list.begin(), list.end(), text) != list.end();
  }

  /// Logs the beacons whose poses come from another process than before.
  void log_owners(const std::vector<PoseWriter>& writers) {
    std::map<std::string, std::set<BeaconAddress>> changed;
    for (const PoseWriter& writer : writers) {
      for (const BeaconAddress address : writer.owned) {
        std::string& owner = owners_[address];
        if (owner == writer.participant_key) continue;
        if (!owner.empty()) changed[text_of(writer.process)].insert(address);
        owner = writer.participant_key;
      }
    }
    for (const auto& [process, beacons] : changed) {
      logging::info(
          fmt::format("the poses of beacons {} come from {} now", fmt::join(beacons, ", "), process));
    }
  }

  dds::Discovery discovery_;
  std::map<BeaconAddress, std::string> owners_;  ///< participants
  std::map<std::string, SteadyTime> logged_;     ///< problems, with the time of their latest line
  std::vector<std::string> seen_;
  std::vector<std::string> warnings_;
};

}  // namespace sonopose::observation::bus
