#pragma once
/// \file
/// The judgement of what became of velocities, for the live fusion, replays and the doctor.

#include <sonopose/samples/estimator_counters.hpp>
#include <sonopose/settings/settings.hpp>

#include <optional>
#include <string>

namespace sonopose::estimation::aiding {

struct TwistProblem {
  bool are_unused = false;     ///< otherwise most contradict the estimate
  bool is_by_setting = false;  ///< true if the settings turn velocities off
  std::string text;
  std::string remedy;
};

/// Set if an engine has used none of the velocities that it counted, or rejected most of them.
std::optional<TwistProblem> twist_problem(const EstimatorCounters& counted,
                                          const settings::Settings& settings);

}  // namespace sonopose::estimation::aiding
