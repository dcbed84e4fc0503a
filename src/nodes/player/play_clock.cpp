#include "player/play_clock.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sonopose::player {

PlayClock::PlayClock(double rate) : rate_(rate) {
  if (!std::isfinite(rate) || rate < 0.0) {
    throw std::invalid_argument("rate = " + std::to_string(rate) +
                                ": must be 0 (as fast as possible) or greater");
  }
}

void PlayClock::begin(std::uint64_t log_time_ns, SteadyTime now) {
  log_time_ns_ = log_time_ns;
  at_ = now;
  if (paused_at_) paused_at_ = now;
}

std::optional<SteadyTime> PlayClock::due(std::uint64_t log_time_ns) const {
  if (paused_at_) return std::nullopt;
  if (rate_ == 0.0 || log_time_ns <= log_time_ns_) return at_;
  constexpr double century_ns = 3e18;  // recorded times may have any value
  const double passed_ns = static_cast<double>(log_time_ns - log_time_ns_) / rate_;
  return at_ + static_cast<TimeNs>(std::min(passed_ns, century_ns));
}

void PlayClock::pause(SteadyTime now) {
  if (!paused_at_) paused_at_ = now;
}

void PlayClock::resume(SteadyTime now) {
  if (!paused_at_) return;
  at_ = at_ + (now - *paused_at_);
  paused_at_.reset();
}

void PlayClock::step_to(std::uint64_t log_time_ns) {
  if (!paused_at_) return;
  log_time_ns_ = std::max(log_time_ns_, log_time_ns);
  at_ = *paused_at_;
}

}  // namespace sonopose::player
