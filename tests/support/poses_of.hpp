#pragma once
/// \file
/// Poses of an engine that processes events.

#include <sonopose/estimation/estimator.hpp>

#include <variant>
#include <vector>

namespace sonopose::test {

std::vector<FusedPose> poses_of(auto& engine, const std::vector<Event>& events) {
  std::vector<FusedPose> poses;
  for (const Event& event : events) {
    const auto result = estimation::process(engine, event);
    if (const auto* pose = std::get_if<FusedPose>(&result)) poses.push_back(*pose);
  }
  return poses;
}

}  // namespace sonopose::test
