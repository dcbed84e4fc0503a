#include "recording/step_back.hpp"

#include <algorithm>

namespace sonopose::recording {

namespace {

constexpr double min_step_s = 0.1;
constexpr double max_apart_s = 1.0;   // streams have samples several times a second
constexpr std::size_t min_older = 4;  // a single stamp may be wrong

bool is_large(const StepBack& step) {
  return seconds_between(step.after_ns, step.before_ns) >= min_step_s;
}

bool is_near(TimeNs a_ns, TimeNs b_ns) {
  const double apart_s = seconds_between(a_ns, b_ns);
  return apart_s >= -max_apart_s && apart_s <= max_apart_s;
}

}  // namespace

std::vector<std::vector<std::size_t>> cuts_at_common_steps(const std::vector<StepsBack>& streams) {
  std::vector<std::vector<std::size_t>> cuts(streams.size());
  std::vector<std::size_t> next(streams.size());  // index of the first step after the latest cut
  const auto others = std::count_if(streams.begin() + 1, streams.end(),
                                    [](const StepsBack& stream) { return stream.has_samples(); });
  if (others == 0) return cuts;
  for (const StepBack& step : streams.front().found()) {
    if (!is_large(step) || step.older < min_older) continue;
    std::vector<std::size_t> found = next;
    const auto shows_step = [&](std::size_t i) {
      const std::vector<StepBack>& steps = streams[i].found();
      const auto same = std::find_if(steps.begin() + static_cast<std::ptrdiff_t>(next[i]), steps.end(),
                                     [&step](const StepBack& other) {
                                       return is_large(other) && is_near(other.before_ns, step.before_ns) &&
                                              is_near(other.after_ns, step.after_ns);
                                     });
      found[i] = static_cast<std::size_t>(same - steps.begin()) + 1;
      return same != steps.end();
    };
    bool is_common = true;
    for (std::size_t i = 1; i < streams.size() && is_common; ++i) {
      is_common = !streams[i].has_samples() || shows_step(i);
    }
    if (!is_common) continue;
    next = found;
    cuts.front().push_back(step.index);
    for (std::size_t i = 1; i < streams.size(); ++i) {
      if (streams[i].has_samples()) cuts[i].push_back(streams[i].found()[next[i] - 1].index);
    }
  }
  return cuts;
}

}  // namespace sonopose::recording
