#pragma once
/// \file
/// Logs processes that should not write poses.

#include "logging/log.hpp"
#include "observation/pose_writers.hpp"
#include <sonopose/dds/binding/discovery.hpp>
#include <sonopose/dds/binding/participant.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::observation::bus {

/// Checks the processes that write poses, and logs new problems. A problem counts once two consecutive checks
/// find it, because a process starts and ends in parts.
class PoseWriterLog {
public:
  explicit PoseWriterLog(const dds::DomainParticipant& participant) : discovery_(participant) {}

  void log(const ServedBeacons& served) {
    std::vector<std::string> seen;
    std::vector<std::string> confirmed;
    for (const auto& problem :
         problems_of(pose_writers_of(discovery_.writers(), discovery_.participants(), served))) {
      seen.push_back(problem.what);
      if (contains(seen_, problem.what)) confirmed.push_back(problem.what);
    }
    for (const std::string& text : confirmed) {
      if (!contains(warnings_, text)) logging::warning(text);
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

  dds::Discovery discovery_;
  std::vector<std::string> seen_;
  std::vector<std::string> warnings_;
};

}  // namespace sonopose::observation::bus
