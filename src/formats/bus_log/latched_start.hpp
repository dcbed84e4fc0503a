#pragma once
/// \file
/// The state of latched topics where a part of a recording begins.

#include "mcap/chunk.hpp"
#include "mcap/reader.hpp"
#include <sonopose/dds/qos/provider.hpp>

#include <functional>
#include <string>
#include <vector>

namespace sonopose::bus_log {

struct LatchedStart {
  mcap::Chunk samples{};               ///< logged at the start of the selection
  std::vector<std::string> damages{};  ///< descriptions of what could not be read before it
};

/// The latest sample of each instance of the selected latched topics before the start of the selection,
/// without instances that ended. Empty if the recording has nothing before or after the start. Native topics
/// are latched by the QoS, others by the QoS that their channel offers. Gives up when `is_stopped`.
LatchedStart latched_start(const mcap::Reader& reader, const mcap::Selection& selection,
                           const dds::qos::Provider& qos, const std::function<bool()>& is_stopped = {});

}  // namespace sonopose::bus_log
