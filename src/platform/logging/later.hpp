#pragma once
/// \file
/// Formats log lines on the thread of the log.

#include <functional>

namespace sonopose::logging {

/// Calls `log` on the thread of the session, where it formats and logs its lines; without a session
/// immediately. For threads that handle samples, which only record changes. At most 2048 calls wait; further
/// ones are dropped and counted in the log. `log` must own what it uses. Its lines get the time and order of
/// this call, unless so many lines wait that some are dropped. Thread-safe; never throws.
void later(std::function<void()> log) noexcept;

}  // namespace sonopose::logging
