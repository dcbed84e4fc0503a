#pragma once
/// \file
/// Watches all beacons on the bus, for the monitor and the web page.

#include "observation/beacon_observers.hpp"
#include "presence/beacon_admission.hpp"
#include "process/endpoint_counters.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::observation::bus {

/// Additional receiver of the samples. Poses arrive on Cyclone's receive threads, the others on the thread of
/// BusWatch::poll.
class SampleHook {
public:
  SampleHook() = default;
  SampleHook(const SampleHook&) = delete;
  SampleHook& operator=(const SampleHook&) = delete;
  virtual ~SampleHook() = default;

  virtual void on(const FusedPose& /*pose*/) noexcept {}
  virtual void on(const TruthSample& /*truth*/) noexcept {}
  virtual void on(const FixReport& /*report*/) noexcept {}
  virtual void on(const BeaconStatus& /*status*/) noexcept {}
  virtual void on(const FusionStatus& /*status*/) noexcept {}
  virtual void on(const Estimate& /*estimate*/) noexcept {}
};

struct BusWatchOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;  ///< most beacons at a time
  bool has_reports = false;  ///< subscribes to the reports of fixes
};

/// One second of observations.
struct BusSnapshot {
  std::vector<BeaconView> beacons;    ///< ordered by address
  std::vector<std::string> warnings;  ///< current warnings
  std::vector<BeaconView> gone;       ///< forgotten beacons: summaries of their visits
};

/// Logs pose streams that fall silent, beacons that are gone, new problems of pose writers, and samples that
/// this process lost. Use it from one thread.
class BusWatch {
public:
  /// `hook` may be null; otherwise it must outlive the watch. Throws dds::core::Exception,
  /// dds::qos::FileError.
  explicit BusWatch(const BusWatchOptions& options, SampleHook* hook = nullptr);
  BusWatch(const BusWatch&) = delete;
  BusWatch& operator=(const BusWatch&) = delete;
  ~BusWatch();

  [[nodiscard]] const dds::domain::DomainParticipant& participant() const;
  [[nodiscard]] const dds::qos::Provider& qos() const;

  /// Takes new samples; call it many times a second. Returns the pose streams that fell silent or resumed.
  std::vector<PoseSilence> poll();

  /// Takes the observations of a second. Call it once a second.
  BusSnapshot take_snapshot();

  /// Summaries of the present beacons, since their start.
  std::vector<BeaconView> summaries();

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sonopose::observation::bus
