#pragma once
/// \file
/// Lets a process that only watches give way to those that it watches.

namespace sonopose::process {

/// The calling thread, and the threads that it starts from now on, never interrupt another thread when they
/// wake up (SCHED_BATCH). They get the same share of the cores as before. Has no effect if the user has
/// chosen another scheduling policy (chrt), or if Linux refuses.
void give_way();

}  // namespace sonopose::process
