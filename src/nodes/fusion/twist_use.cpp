#include "fusion/twist_use.hpp"

#include <fmt/format.h>

#include <utility>

namespace sonopose::fusion {

std::optional<std::string> TwistUse::update(const EstimatorCounters& counted, settings::EngineKind engine) {
  const EstimatorCounters since = counted - std::exchange(before_, counted);
  const std::uint64_t judged = since.twists_used + since.twists_rejected;
  if (judged == 0) {
    if (since.twists_unused == 0 || ++unused_updates_ != max_unused_updates) return std::nullopt;
    return engine == settings::EngineKind::documented
               ? "velocities are not used: the documented engine uses none; remedy: fusion.engine = "
                 "\"kalman\""
               : "velocities are not used: they have no linear part, there was no fix, or "
                 "kalman.twist.enabled is false";
  }
  unused_updates_ = 0;
  const bool contradicts = 2 * since.twists_rejected > judged;
  if (contradicts == std::exchange(contradicts_, contradicts)) return std::nullopt;
  if (!contradicts) return "velocities agree with the estimate again";
  return fmt::format(
      "velocities contradict the estimate, as when wheels slip: {} of the last {} are rejected",
      since.twists_rejected, judged);
}

}  // namespace sonopose::fusion
