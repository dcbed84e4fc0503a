#pragma once
/// \file
/// The doctor process: looks at the bus for some seconds and collects what `diagnose` judges.

#include <sonopose/dds/binding/domain.hpp>
#include "doctor/rules/doctor.hpp"
#include "process/stop_signal.hpp"

#include <filesystem>
#include <optional>

namespace sonopose::doctor {

struct DoctorOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  double duration_s = 3;
};

/// Watches for the duration (and half a second before it, to find everybody), or until the stop. Where a
/// bridge or a fusion is missing it looks into domains 0…20 and that of ROS_DOMAIN_ID, one after the other.
/// Throws dds::Error, dds::QosFileError.
Observations observe(const DoctorOptions& options, const process::StopSignal& stop);

}  // namespace sonopose::doctor
