#pragma once
/// \file
/// Reads the outputs of the fusion from a recording of the bus.

#include "mcap/reader.hpp"
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <functional>

namespace sonopose::bus_log {

/// Calls back with each pose and report of one beacon, in recorded order. Throws files::IoError.
void for_each_output(const mcap::Reader& reader, BeaconAddress address,
                     const std::function<void(const FusedPose&)>& on_pose,
                     const std::function<void(const FixReport&)>& on_report);

}  // namespace sonopose::bus_log
