#pragma once
/// \file
/// The web process with a recording instead of the bus.

#include "process/stop_signal.hpp"
#include "web/http/server.hpp"
#include "web/map_layers.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::web {

struct RecordingOptions {
  /// MCAP or rosbag2 files, a log of the vendor's Dashboard, or a sensor-log folder
  std::vector<std::filesystem::path> recording;
  std::optional<BeaconAddress> beacon;  ///< selects one beacon of several
  http::ServerOptions server;
  MapLayers map;
  std::string version;
};

/// Reads the recording, and serves the page until the stop, which listens to signals from then on. Throws
/// files::IoError, std::runtime_error if it cannot listen.
void serve_recording(const RecordingOptions& options, const http::OnReady& on_ready,
                     process::StopSignal& stop);

}  // namespace sonopose::web
