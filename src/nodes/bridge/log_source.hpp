#pragma once
/// \file
/// A sensor-log folder as a source.

#include "publication/source.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace sonopose::bridge {

struct LogOptions {
  std::filesystem::path folder;
  std::optional<BeaconAddress> address = {};  ///< replaces the log's address
  double rate = 1;                            ///< playback speed (Pacer); 1: real time
  bool restamp = false;                       ///< shifts the stamps so that the recording starts now
};

/// The events of a sensor-log folder, and its ground truth if it has one. Throws files::IoError.
std::unique_ptr<publication::Source> make_log_source(const LogOptions& options);

}  // namespace sonopose::bridge
