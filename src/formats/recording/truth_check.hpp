#pragma once
/// \file
/// Checks that a true trajectory is that of the recording: frame, units, axes.

#include "motion/window.hpp"
#include <sonopose/samples/samples.hpp>

#include <string>
#include <vector>

namespace sonopose::recording {

/// Sensors that a truth can be compared with: those whose stamps and units are right as far as known.
struct TruthReferences {
  bool fixes = true;
  bool gyroscope = true;
};

/// Sentences about a truth that contradicts fixes, gyroscope or itself. Truth and window are in the order of
/// their times.
std::vector<std::string> truth_findings(const std::vector<TruthSample>& truth, const motion::Window& window,
                                        TruthReferences references);

}  // namespace sonopose::recording
