#pragma once
/// \file
/// The web process with a recording instead of the bus.

#include "process/stop_signal.hpp"
#include "web/http/server.hpp"
#include "web/map_layers.hpp"
#include <sonopose/samples/samples.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace sonopose::web {

struct RecordingOptions {
  std::filesystem::path recording;  ///< an MCAP file, a log of the vendor's Dashboard, or a sensor-log folder
  std::optional<BeaconAddress> beacon;  ///< of a file of several
  http::ServerOptions server;
  MapLayers map;
  std::string version;
};

/// Serves the page until the stop. `on_ready` gets its URL, with the token. Throws files::IoError,
/// std::runtime_error if it cannot listen.
void serve_recording(const RecordingOptions& options,
                     const std::function<void(const std::string& url)>& on_ready,
                     const process::StopSignal& stop);

}  // namespace sonopose::web
