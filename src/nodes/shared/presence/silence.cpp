#include "presence/silence.hpp"

namespace sonopose::presence {

std::optional<Silence::Change> Silence::find_change(SteadyTime now, TimeNs deadline_ns) {
  if (!has_changed(now, deadline_ns)) return std::nullopt;
  silent_ = !silent_;
  if (silent_) silent_since_ = *latest_;
  return Change{silent_, seconds_between(silent_since_, silent_ ? now : *latest_)};
}

}  // namespace sonopose::presence
