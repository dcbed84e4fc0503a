#pragma once
/// \file
/// Faults of the installation in a recording.

#include "installation/installation.hpp"
#include <sonopose/samples/samples.hpp>
#include <sonopose/settings/settings.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace sonopose::installation {

/// Extent of the search: `brief` fits a few pieces of the recording, and all unless these show that there is
/// no fault.
enum class Search : std::uint8_t { brief, thorough };

/// Returns the faults that the events of one beacon show; none if units or repeated values make every fit
/// wrong, which recording/input_check.hpp names.
std::vector<Finding> findings_in(std::span<const Event> events, const settings::Settings& settings,
                                 Search search);

}  // namespace sonopose::installation
