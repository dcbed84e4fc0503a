#include <sonopose/estimation/aiding/twist_problem.hpp>

namespace sonopose::estimation::aiding {

std::optional<TwistProblem> twist_problem(const EstimatorCounters& counted,
                                          const settings::Settings& settings) {
  const std::uint64_t judged = counted.twists_used + counted.twists_rejected;
  if (judged <= 1 &&
      counted.twists_unused > judged) {  // one may wait for an IMU sample that refutes its stamp
    const std::string text = "velocities are not used: ";
    if (settings.engine.engine == settings::EngineKind::documented) {
      return TwistProblem{true, true, text + "the documented engine uses none",
                          "set fusion.engine = \"kalman\""};
    }
    if (!settings.twist.enabled) {
      return TwistProblem{true, true, text + "kalman.twist.enabled is false",
                          "set kalman.twist.enabled = true"};
    }
    return TwistProblem{
        true, false,
        text + "they are newer than the IMU samples or too old, have no linear part, or there was no fix",
        "compare their stamps with those of the IMU"};
  }
  if (2 * counted.twists_rejected <= judged) return std::nullopt;
  return TwistProblem{
      false, false,
      "velocities contradict the estimate, as when wheels slip: " + std::to_string(counted.twists_rejected) +
          " of " + std::to_string(judged) + " are rejected",
      "if the wheels do not slip, check sign, scale, frame and stamps of the velocities"};
}

}  // namespace sonopose::estimation::aiding
