#include "fusion/twist_use.hpp"

#include <sonopose/estimation/aiding/twist_problem.hpp>

#include <utility>

namespace sonopose::fusion {

std::optional<std::string> TwistUse::update(const EstimatorCounters& counted,
                                            const settings::Settings& settings) {
  const EstimatorCounters before = std::exchange(before_, counted);
  EstimatorCounters since = counted - before;
  // A velocity whose stamp an IMU sample refutes is counted again, as unused.
  if (counted.twists_used < before.twists_used) since.twists_used = 0;
  if (counted.twists_rejected < before.twists_rejected) since.twists_rejected = 0;
  if (since.twists_used + since.twists_rejected + since.twists_unused == 0) return std::nullopt;
  const auto problem = estimation::aiding::twist_problem(since, settings);
  const auto text = [&problem] { return problem->text + "; remedy: " + problem->remedy; };
  if (problem && problem->are_unused) {
    return ++unused_updates_ == max_unused_updates ? std::optional(text()) : std::nullopt;
  }
  unused_updates_ = 0;
  if (problem.has_value() == std::exchange(contradicts_, problem.has_value())) return std::nullopt;
  return problem ? text() : "velocities agree with the estimate again";
}

}  // namespace sonopose::fusion
