#pragma once
/// \file
/// Numbers, stamps and publishes the samples of one source, for the bridge and the ROS 2 relay, and once a
/// second the status of each beacon.

#include "process/stop_signal.hpp"
#include "publication/source.hpp"
#include "recording/log_meta.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/psm/ext.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

namespace sonopose::publication {

struct PublisherOptions {
  std::optional<std::filesystem::path> qos_file;
  bool lossless = false;  ///< keeps all samples and waits for slow readers
  bool batch = false;     ///< sends samples that are due together in one packet: for many beacons
  /// Sensor-log folder for the published samples. An error ends the recording, not the publishing.
  std::optional<std::filesystem::path> record_folder;
  recording::LogSettings source_settings = {};  ///< for the recording's meta.toml
  /// False if another part of the process publishes its log and reports to the service manager.
  bool publishes_log = true;
};

/// Publishes one source on the bus, with its threads, statuses and recording.
class SensorPublisher {
public:
  /// Joins the domain. Throws dds::core::Exception, dds::qos::FileError, files::IoError, and
  /// std::invalid_argument for a folder that can never be recorded into.
  SensorPublisher(const dds::DomainOptions& domain, const PublisherOptions& options);
  /// Uses a participant. Throws std::invalid_argument for `lossless` and `batch`, which are also options of
  /// its domain.
  SensorPublisher(const dds::domain::DomainParticipant& participant, const PublisherOptions& options);
  SensorPublisher(const SensorPublisher&) = delete;
  SensorPublisher& operator=(const SensorPublisher&) = delete;
  ~SensorPublisher();

  /// Publishes the samples of `source` until it ends or the stop is requested. A recording waits at the start
  /// until each stream has a reader, and at the end until the readers have received everything. Throws what
  /// the source throws.
  void run(Source& source, const process::StopSignal& stop);

  /// Number of events of a lossless recording that fusions have lost, because they are not lossless; at least
  /// 1 if the last reader ended before the recording.
  [[nodiscard]] std::uint64_t lost_by_fusions() const;

  /// Waits until a recording is written. Throws files::IoError if samples are missing from it. Call it at the
  /// end.
  void finish();

private:
  class Publisher;
  std::unique_ptr<Publisher> publisher_;
};

}  // namespace sonopose::publication
