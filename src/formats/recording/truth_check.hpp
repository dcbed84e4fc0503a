#pragma once
/// \file
/// Checks that a true trajectory is that of the recording: frame, units, axes.

#include "motion/window.hpp"
#include <sonopose/samples/samples.hpp>

#include <optional>
#include <string>
#include <vector>

namespace sonopose::recording {

/// Sentence about a truth that contradicts fixes, gyroscope or itself; empty if it does not. Both are in the
/// order of their times.
std::optional<std::string> truth_finding(const std::vector<TruthSample>& truth, const motion::Window& window);

}  // namespace sonopose::recording
