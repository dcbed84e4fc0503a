#pragma once
/// \file
/// Log lines that are formed on the thread of the log.

#include <functional>

namespace sonopose::logging {

/// Calls `log` on the thread of the session, where it forms its lines and logs them; without a session at
/// once. For threads that samples pass: they only record what has changed. At most 256 calls wait; what is
/// more is left out, and its number is logged. `log` must own what it uses. Calls are made in their order,
/// one at a time. Thread-safe; never throws.
void later(std::function<void()> log) noexcept;

}  // namespace sonopose::logging
