#pragma once
/// \file
/// The monitor process: subscribes to all topics and shows them on a screen, as a table, or as JSON for
/// programs.

#include "monitor/display.hpp"
#include "presence/beacon_admission.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>

namespace sonopose::monitor {

struct MonitorOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;  ///< most to show at a time
  Output output = Output::table;  ///< a summary follows a table and a screen
  double duration_s = 0;          ///< 0: run until stopped
};

/// Shows its observations until the stop or the end of the duration; the key q requests the stop. Returns the
/// number of poses received. Throws dds::core::Exception, dds::qos::FileError, std::system_error.
std::uint64_t monitor(const MonitorOptions& options, process::StopSignal& stop);

}  // namespace sonopose::monitor
