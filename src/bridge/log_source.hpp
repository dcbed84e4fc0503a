#pragma once
/// \file
/// A sensor-log folder as a source.

#include "bridge/source.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace sonopose::bridge {

struct LogOptions {
  std::filesystem::path folder;
  std::optional<BeaconAddress> address = {};  ///< instead of the log's
  double rate = 1;                            ///< of time: see Pacer
  bool restamp = false;                       ///< shift the stamps so that the recording begins now
};

/// The events of a sensor-log folder, with its ground truth where it has one. Throws files::IoError.
std::unique_ptr<Source> make_log_source(const LogOptions& options);

}  // namespace sonopose::bridge
