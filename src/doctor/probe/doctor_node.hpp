#pragma once
/// \file
/// The doctor process: collects observations of the bus for some seconds.

#include "doctor/rules/observations.hpp"
#include "process/beacon_admission.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>

namespace sonopose::doctor::probe {

struct DoctorOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  double duration_s = 8;
  std::size_t max_beacons = process::BeaconAdmission::default_max_beacons;  ///< to look at
  double fits_s = 30;                             ///< for the motion of all beacons, after the look
  std::function<void(double share)> on_fit = {};  ///< called before each beacon's
};

/// Observes the system for the duration, after half a second of discovery, or until the stop; an empty domain
/// for 2 s at most. If there is no bridge or no fusion, searches all domains. Throws dds::Error,
/// dds::qos::FileError.
rules::Observations observe(const DoctorOptions& options, const process::StopSignal& stop);

}  // namespace sonopose::doctor::probe
