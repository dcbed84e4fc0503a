#pragma once
/// \file
/// The doctor process: observes the bus for some seconds.

#include "doctor/rules/observations.hpp"
#include "presence/beacon_admission.hpp"
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
  std::size_t max_beacons = presence::BeaconAdmission::default_max_beacons;  ///< most beacons to observe
  double fits_s = 30;                             ///< processor time for the fits of all beacons
  std::function<void(double share)> on_fit = {};  ///< called before each beacon's fit
};

/// Observes the system for the duration, after half a second of discovery, or until the stop. Observes an
/// empty domain for at most 2 s. If there is no bridge or no fusion, searches all domains. Throws
/// dds::core::Exception, dds::qos::FileError.
rules::Observations observe(const DoctorOptions& options, const process::StopSignal& stop);

}  // namespace sonopose::doctor::probe
