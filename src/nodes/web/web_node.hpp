#pragma once
/// \file
/// The web process: serves a page that shows the bus live, and the topics for Foxglove.

#include "presence/beacon_admission.hpp"
#include "process/stop_signal.hpp"
#include "web/http/server.hpp"
#include "web/map_layers.hpp"
#include "web/request_worker.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace sonopose::web {

struct WebOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;  ///< most to show at a time
  http::ServerOptions server;
  bool allows_changes = false;  ///< permits changes of settings, and resets
  MapLayers map;
  Examine examine;        ///< the doctor that the page starts
  std::string on_status;  ///< command for StatusHook
  std::string version;
};

/// Serves until the stop. Throws dds::core::Exception, dds::qos::FileError, std::runtime_error if it cannot
/// listen.
void serve(const WebOptions& options, const http::OnReady& on_ready, const process::StopSignal& stop);

}  // namespace sonopose::web
