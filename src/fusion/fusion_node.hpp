#pragma once
/// \file
/// The fusion process: takes events from DDS, runs one engine per beacon, writes poses and reports, and
/// changes settings and resets on request.

#include "config/fusion_config.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include "process/address_set.hpp"
#include "fusion/standby.hpp"
#include "process/stop_signal.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace sonopose::fusion {

struct FusionOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  config::FusionConfig config;
  process::AddressSet addresses;                   ///< serve these beacons alone
  std::optional<StandbyOptions> standby;  ///< stand by for others, or be stood by for; not with `lossless`
  bool lossless = false;  ///< keep all events and poses, for a log that is played as fast as it can be
};

/// Live, each event is taken, fused and its pose written on Cyclone's receive thread, the quickest way there
/// is. Lossless, a thread of its own waits for events, because it must be able to wait for consumers too.
class FusionNode {
public:
  /// Joins the domain and begins to serve. Throws dds::Error, dds::QosFileError.
  explicit FusionNode(const FusionOptions& options);
  FusionNode(const FusionNode&) = delete;
  FusionNode& operator=(const FusionNode&) = delete;
  ~FusionNode();

  /// Publishes the status of every beacon once a second, and at once when its IMU falls silent or comes back,
  /// until the stop. With a standby, serves on for a lease then, so that it can take over.
  void run(const process::StopSignal& stop);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonopose::fusion
