#pragma once
/// \file
/// The listeners to the log of this process.

#include "logging/log.hpp"
#include "threads/mutex.hpp"

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace sonopose::logging {

/// A line that owns its text.
struct KeptLine {
  Level level;
  std::int64_t time_ns;
  std::string text;
};

/// The listeners, called under the lock, so that none is called after its end.
class Listeners {
public:
  void add(Listener& listener);

  /// Waits for a call that is in progress.
  void remove(const Listener& listener);

  /// Passes a line to the listeners, on the thread of the session. `earlier`: its lines before this one, for
  /// new listeners.
  void pass_on(const Line& line, const std::deque<KeptLine>& earlier);

private:
  struct Entry {
    Listener* listener;
    bool is_new = true;
  };

  threads::Mutex mutex_;
  std::vector<Entry> entries_ SONOPOSE_GUARDED_BY(mutex_);
};

/// The listeners of this process.
Listeners& listeners();

}  // namespace sonopose::logging
