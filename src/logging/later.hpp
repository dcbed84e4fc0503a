#pragma once
/// \file
/// Log lines that are formed on the thread of the log.

#include <functional>

namespace sonopose::logging {

/// Calls `log` on the thread of the session, where it forms its lines and logs them; without a session at
/// once. For threads that handle samples: they only record what has changed. At most 2048 calls wait; further
/// ones are dropped and counted in the log. `log` must own what it uses. Its lines have the time and the
/// place in the order that a line logged by this call would have, unless so many lines wait that some are
/// dropped. Thread-safe; never throws.
void later(std::function<void()> log) noexcept;

}  // namespace sonopose::logging
