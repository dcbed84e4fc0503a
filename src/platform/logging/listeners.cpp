#include "logging/listeners.hpp"

#include <utility>

namespace sonopose::logging {

void Listeners::add(Listener& listener) {
  const threads::Lock lock(mutex_);
  entries_.push_back({&listener});
}

void Listeners::remove(const Listener& listener) {
  const threads::Lock lock(mutex_);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.listener == &listener; });
}

void Listeners::pass_on(const Line& line, const std::deque<KeptLine>& earlier) {
  const threads::Lock lock(mutex_);
  for (Entry& entry : entries_) {
    if (std::exchange(entry.is_new, false)) {
      for (const KeptLine& each : earlier) entry.listener->on({each.level, each.time_ns, each.text});
    }
    entry.listener->on(line);
  }
}

Listeners& listeners() {
  static auto* const all = new Listeners;  // never destroyed: a listener may be a static object
  return *all;
}

}  // namespace sonopose::logging
