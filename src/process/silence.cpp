#include "process/silence.hpp"

namespace sonopose::process {

std::optional<Silence::Change> Silence::find_change(SteadyTime now, TimeNs deadline_ns) {
  if (!latest_) return std::nullopt;
  const bool silent = now - *latest_ > deadline_ns;
  if (silent == silent_) return std::nullopt;
  silent_ = silent;
  if (silent) silent_since_ = *latest_;
  return Change{silent, seconds_between(silent_since_, silent ? now : *latest_)};
}

}  // namespace sonopose::process
