#include "transitions/transition_log.hpp"

#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <utility>

namespace sonopose::transitions {

TransitionLog::TransitionLog()
    : TransitionLog([](const LogText& line) { logging::write(line.level, line.text); }) {}

TransitionLog::TransitionLog(Write write) : write_(std::move(write)) {}

void TransitionLog::on(const Transition& transition, SteadyTime now) {
  Flapping& flapping = beacons_[transition.address].at(static_cast<std::size_t>(transition.kind));
  if (flapping.limit.report_due(now)) update(now);
  if (flapping.limit.admits(now)) {
    write_(line_of(transition));
  } else {
    flapping.latest = transition;
  }
}

void TransitionLog::take(TransitionQueue& pending, SteadyTime now) {
  for (const Transition& transition : pending.values()) on(transition, now);
  dropped_ += pending.dropped();
  pending.clear();
}

void TransitionLog::report(Flapping& flapping) {
  LogText line = line_of(flapping.latest);
  const std::uint64_t others = flapping.limit.take_suppressed() - 1;
  if (others > 0) {
    line.text += fmt::format(" ({} not logged)",
                             text::count_text(others, "earlier change was", "earlier changes were"));
  }
  write_(line);
}

void TransitionLog::report_dropped() {
  if (dropped_ == 0) return;
  write_({logging::Level::warning,
          fmt::format(
              "{} not logged: too many at a time",
              text::count_text(std::exchange(dropped_, 0), "change of state was", "changes of state were"))});
}

void TransitionLog::update(SteadyTime now) {
  for (auto& [address, flapping] : beacons_) {
    for (Flapping& each : flapping) {
      if (!each.limit.report_due(now)) continue;
      report(each);
      each.limit.admits(now);
    }
  }
  report_dropped();
}

void TransitionLog::forget(BeaconAddress address) {
  const auto found = beacons_.find(address);
  if (found == beacons_.end()) return;
  for (Flapping& each : found->second) {
    if (each.limit.has_suppressed()) report(each);
  }
  beacons_.erase(found);
}

void TransitionLog::finish() {
  while (!beacons_.empty()) forget(beacons_.begin()->first);
  report_dropped();
}

}  // namespace sonopose::transitions
