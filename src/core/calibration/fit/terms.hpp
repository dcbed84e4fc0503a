#pragma once
/// \file
/// Numbers of one sensor's model by name.

#include <sonopose/calibration/model/settings.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <string>
#include <vector>

namespace sonopose::calibration::fit {

/// One number of a model: its row in the table of settings, and its value.
struct Term {
  const settings::SettingInfo* info;
  double value;
};

/// All numbers of a model, in the order of the table.
std::vector<Term> terms_of(const GyroscopeSettings& model);
std::vector<Term> terms_of(const AccelerometerSettings& model);
std::vector<Term> terms_of(const MagnetometerSettings& model);

/// Names the first number that its setting does not allow, as an explanation for the user; empty if all are
/// allowed.
std::string out_of_range(const std::vector<Term>& terms);

}  // namespace sonopose::calibration::fit
