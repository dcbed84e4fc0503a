#pragma once
/// \file
/// The fusion process: takes events from DDS, runs one estimator per beacon, writes poses and reports, and
/// changes settings and resets on request.

#include "config/fusion_config.hpp"
#include "fusion/standby.hpp"
#include "presence/beacon_admission.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace sonopose::fusion {

struct FusionOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  config::FusionConfig config;
  presence::AddressSet addresses;                                            ///< only beacons to serve
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;  ///< most beacons at a time
  std::optional<StandbyOptions> standby;  ///< shares the beacons with other processes; not with `lossless`
  std::optional<std::filesystem::path> learned_file{};  ///< keeps what is learned; not `lossless`
  bool lossless = false;  ///< keeps all events and poses, for a log at full speed
  /// Reads the configuration again, when process::ReloadRequest asks for it. Throws config::ConfigError.
  std::function<config::FusionConfig()> read_again = {};
};

/// Live, the whole path from event to pose runs on Cyclone's receive thread, which is the fastest. Lossless,
/// it runs on a separate thread, which may wait for consumers.
class FusionNode {
public:
  /// Joins the domain and starts. Throws dds::core::Exception, dds::qos::FileError.
  explicit FusionNode(const FusionOptions& options);
  FusionNode(const FusionNode&) = delete;
  FusionNode& operator=(const FusionNode&) = delete;
  ~FusionNode();

  /// Publishes the status of every beacon once a second, and immediately when its IMU falls silent or
  /// resumes, until the stop. A standby process then continues for a lease, so that another can take over.
  void run(const process::StopSignal& stop);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonopose::fusion
