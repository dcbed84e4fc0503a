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

namespace sonopose::web {

struct RecordingOptions {
  std::filesystem::path recording;      ///< MCAP file, log of the vendor's Dashboard, or sensor-log folder
  std::optional<BeaconAddress> beacon;  ///< selects one beacon of a file of several
  http::ServerOptions server;
  MapLayers map;
  std::string version;
};

/// Reads the recording, and serves the page until the stop, which listens to signals from then on. Throws
/// files::IoError, std::runtime_error if it cannot listen.
void serve_recording(const RecordingOptions& options, const http::OnReady& on_ready,
                     process::StopSignal& stop);

}  // namespace sonopose::web
