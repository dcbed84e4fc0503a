#pragma once
/// \file
/// The monitor process: subscribes to all topics and prints a live table, or JSON for programs.

#include "process/beacon_admission.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>

namespace sonopose::monitor {

struct MonitorOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::size_t max_beacons = process::BeaconAdmission::default_max_beacons;  ///< to show at a time
  bool json = false;      ///< print one object per second instead of the table and the summary
  bool redraw = false;    ///< overwrite the previous table (on a terminal)
  double duration_s = 0;  ///< 0: run until stopped
};

/// Prints to standard output until the stop or the end of the duration. Returns the number of poses received.
/// Throws dds::Error, dds::qos::FileError.
std::uint64_t monitor(const MonitorOptions& options, const process::StopSignal& stop);

}  // namespace sonopose::monitor
