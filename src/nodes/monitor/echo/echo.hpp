#pragma once
/// \file
/// Prints each sample of one topic as a line of JSON, for programs in any language.

#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::monitor::echo {

struct EchoOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::string topic;                    ///< "imu" for sonopose/imu
  std::optional<BeaconAddress> beacon;  ///< only beacon to print; empty: all
  std::uint64_t count = 0;              ///< number of samples to print; 0: no limit
  double duration_s = 0;                ///< 0: run until stopped
};

/// Prints to standard output until the stop, the end of count or duration, or the loss of its reader. Returns
/// false if the duration ended without a sample. Throws dds::core::Exception, dds::qos::FileError,
/// std::system_error, std::invalid_argument for an unknown topic, and for a beacon of a topic without
/// beacons.
bool echo(const EchoOptions& options, const process::StopSignal& stop);

}  // namespace sonopose::monitor::echo
