#pragma once
/// \file
/// What must be restored although the process ends without its destructors.

namespace sonopose::process {

/// Only async-signal-safe calls.
using SuddenEndCall = void (*)() noexcept;

/// A repeated stop signal, which ends the process at once (StopSignal::listen_to_signals), calls `call`
/// first. A call that takes more than 1 s is cut short: SIGALRM then ends the process. Null: nothing. One per
/// process.
void set_sudden_end_call(SuddenEndCall call) noexcept;

}  // namespace sonopose::process
