#pragma once
/// \file
/// Faults of an IMU that its readings show whatever their unit, scale and sign.

#include "motion/window.hpp"

#include <string>
#include <vector>

namespace sonopose::motion {

/// Texts about an accelerometer that reads 0, samples that are repeated while the body moves, samples of two
/// sensors in turns, and axes or sensors that keep one value while others vary: "axis x of the accelerometer
/// is stuck at 0.00 m/s^2". The readings are finite, in order of time and in the sensor's own axes.
std::vector<std::string> imu_faults_of(const Window& window);

/// Removes the readings of an accelerometer that reads 0 for a while, and the samples that are repeated while
/// the body moves.
void remove_held_readings(Window& window);

}  // namespace sonopose::motion
