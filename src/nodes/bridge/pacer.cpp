#include "bridge/pacer.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include <sonopose/text/duration_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sonopose::bridge {

Pacer::Pacer(double rate) : rate_(rate) {
  if (!std::isfinite(rate) || rate < 0.0) {
    throw std::invalid_argument("rate = " + std::to_string(rate) +
                                ": must be 0 (as fast as possible) or greater");
  }
}

void Pacer::restart_at(TimeNs time_ns) {
  first_ns_ = time_ns;
  began_ = clocks::steady_now();
  if (!begun_) ticked_ = began_;
  begun_ = true;
}

bool Pacer::wait_for(TimeNs time_ns, publication::SampleSink& sink, const process::StopSignal& stop) {
  constexpr TimeNs tick_period_ns = 100'000'000;
  SteadyTime now = clocks::steady_now();
  if (!begun_) restart_at(time_ns);
  constexpr double century_ns = 3e18;  // recorded stamps may have any value
  const auto passed_ns = static_cast<double>(saturated_difference(time_ns, first_ns_));
  const SteadyTime due =
      rate_ == 0.0 ? now
                   : began_ + static_cast<TimeNs>(std::clamp(passed_ns / rate_, -century_ns, century_ns));
  constexpr TimeNs logged_wait_ns = 5'000'000'000;
  if (due - now >= logged_wait_ns) {
    logging::warning(fmt::format("the next sample is due in {}",
                                 text::duration_text(static_cast<double>(due - now) * 1e-9)));
  }
  while (true) {
    if (now - ticked_ >= tick_period_ns) {
      sink.tick();
      ticked_ = now;
      if (stop.requested()) return false;
    }
    if (now >= due) return true;
    sink.flush();
    if (stop.wait_until(std::min(due, ticked_ + tick_period_ns))) return false;
    now = clocks::steady_now();
  }
}

}  // namespace sonopose::bridge
