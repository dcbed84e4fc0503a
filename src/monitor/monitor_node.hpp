#pragma once
/// \file
/// The monitor process: a consumer of everything, for people (a live table) and programs (JSON).

#include <sonopose/dds/binding/domain.hpp>
#include "process/stop_signal.hpp"

#include <filesystem>
#include <optional>

namespace sonopose::monitor {

struct MonitorOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  bool json = false;      ///< one object a second, instead of the table and the summary
  bool redraw = false;    ///< draw the table over the last one (a terminal)
  double duration_s = 0;  ///< 0: without end
};

/// Watches until the stop or the end of the duration, and prints to standard output. Returns how many poses
/// were seen. Throws dds::Error, dds::QosFileError.
std::uint64_t monitor(const MonitorOptions& options, const process::StopSignal& stop);

}  // namespace sonopose::monitor
