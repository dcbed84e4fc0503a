#pragma once
/// \file
/// Simulated recordings for the tests.

#include "recording/log_folder.hpp"
#include "sim/simulator.hpp"

#include <string_view>

namespace sonopose::test {

inline recording::SensorLog sample_log(std::string_view scenario = "walk", double duration_s = 20.0) {
  sim::Recording recording = sim::record(sim::find_scenario(scenario), {.duration_s = duration_s});
  return {std::move(recording.events), std::move(recording.truth)};
}

}  // namespace sonopose::test
