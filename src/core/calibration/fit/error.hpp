#pragma once
/// \file
/// The only exception of this folder.

#include <stdexcept>

namespace sonopose::calibration::fit {

/// A recording from which no calibration follows. The message says what was found, what is needed, and what
/// to do about it.
class CalibrationError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

}  // namespace sonopose::calibration::fit
