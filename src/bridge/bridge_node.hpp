#pragma once
/// \file
/// The bridge process: publishes what a source brings, once converted, numbered and stamped.

#include <sonopose/dds/binding/domain.hpp>
#include "bridge/source.hpp"
#include "process/stop_signal.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace sonopose::bridge {

struct BridgeOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  bool lossless = false;  ///< keep all and wait for slow readers
  bool batch = false;     ///< samples that are due at once travel together: for many beacons
  std::optional<std::filesystem::path> record_folder;  ///< write what is published as a sensor-log folder
};

class BridgeNode {
public:
  /// Joins the domain. Throws dds::Error, dds::QosFileError, io::LogError.
  explicit BridgeNode(const BridgeOptions& options);
  BridgeNode(const BridgeNode&) = delete;
  BridgeNode& operator=(const BridgeNode&) = delete;
  ~BridgeNode();

  /// Publishes what `source` brings until it ends or the stop comes. A recording waits until each of its
  /// streams has a reader, and in the end until the readers have it all.
  void run(Source& source, const process::StopSignal& stop);

private:
  class Publisher;
  std::unique_ptr<Publisher> publisher_;
};

}  // namespace sonopose::bridge
