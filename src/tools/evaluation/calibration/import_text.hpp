#pragma once
/// \file
/// Describes imported tables: rates, gaps, gravity and the offset of the clocks.

#include "recording/tables.hpp"

#include <string>

namespace sonopose::evaluation {

/// Writes a few lines about the samples. Estimates the offset of the clocks if the body moves enough, which
/// takes a while.
std::string import_text(const recording::Tables& tables);

}  // namespace sonopose::evaluation
