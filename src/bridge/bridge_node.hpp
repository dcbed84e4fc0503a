#pragma once
/// \file
/// The bridge process: converts, numbers and stamps the samples of one source and publishes them.

#include "bridge/source.hpp"
#include "process/stop_signal.hpp"
#include "recording/log_meta.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <filesystem>
#include <memory>
#include <optional>

namespace sonopose::bridge {

struct BridgeOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  bool lossless = false;  ///< keep all samples and wait for slow readers
  bool batch = false;     ///< send samples that are due together in one packet: for many beacons
  /// Write what is published as a sensor-log folder. An error ends the recording, not the publishing.
  std::optional<std::filesystem::path> record_folder;
  recording::LogSettings source_settings = {};  ///< for the recording's meta.toml
  bool publishes_log = true;                    ///< of the process; false if another part of it does
};

class BridgeNode {
public:
  /// Joins the domain. Throws dds::Error, dds::qos::FileError, files::IoError.
  explicit BridgeNode(const BridgeOptions& options);
  BridgeNode(const BridgeNode&) = delete;
  BridgeNode& operator=(const BridgeNode&) = delete;
  ~BridgeNode();

  /// Publishes the samples of `source` until it ends or the stop is requested. A recording waits at the start
  /// until each of its streams has a reader, and at the end until the readers have received everything.
  /// Throws what the source throws.
  void run(Source& source, const process::StopSignal& stop);

  /// Waits at the end until a recording is written. Throws files::IoError if samples are missing in it.
  void finish();

private:
  class Publisher;
  std::unique_ptr<Publisher> publisher_;
};

}  // namespace sonopose::bridge
