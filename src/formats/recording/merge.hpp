#pragma once
/// \file
/// Merges samples into the events of a recording.

#include "recording/log_folder.hpp"
#include <sonopose/samples/samples.hpp>

#include <string>
#include <vector>

namespace sonopose::recording {

/// Merges the streams and numbers the events from 1. An IMU sample comes at its stamp, any other at its
/// receipt; at equal times IMU, fix, heading, velocity. Each stream keeps its order: a row that is earlier
/// than its predecessor follows directly after it. Where the clock of all streams was set back, what came
/// before the step is merged before the rest.
///
/// Leaves out IMU samples with wrong stamps far in the future, which the estimators would follow, and says so
/// in the warnings, after `name`. A stamp counts as wrong if it is more than 1 s later than the stamp before
/// it and than most of the next 128, and the stamps then step back by more than 1 s.
SensorLog merge_by_availability(const std::string& name, const std::vector<ImuSample>& imu,
                                const std::vector<UltrasonicFix>& fixes,
                                const std::vector<PairHeading>& headings,
                                const std::vector<TwistSample>& twists = {});

/// Leaves the same samples out of events that are in order already, numbered from 1, and renumbers them.
void leave_far_ahead_out(const std::string& name, SensorLog& log);

}  // namespace sonopose::recording
