#pragma once
// A consumer of the topics that people watch. It only counts their samples.

#include <atomic>
#include <cstdint>

namespace sonopose::benchmarks {

/// Returns a counter that children share. Throws std::runtime_error.
std::atomic<std::uint64_t>& shared_counter();

/// Counts the samples of the topics that the monitor and the page read, until the process is killed.
[[noreturn]] void count_samples(std::uint32_t domain, std::atomic<std::uint64_t>& count);

}  // namespace sonopose::benchmarks
