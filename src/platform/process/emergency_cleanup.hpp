#pragma once
/// \file
/// Cleanup for an exit without destructors.

namespace sonopose::process {

/// A cleanup that makes only async-signal-safe calls.
using EmergencyCleanup = void (*)() noexcept;

/// Sets a function that a repeated stop signal calls before it ends the process
/// (StopSignal::listen_to_signals). A call that takes more than 1 s is cut short: SIGALRM then ends the
/// process. Null: none. One per process.
void set_emergency_cleanup(EmergencyCleanup call) noexcept;

}  // namespace sonopose::process
