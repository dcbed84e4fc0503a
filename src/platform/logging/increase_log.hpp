#pragma once
/// \file
/// Bounds how often a counter of losses is logged: while the cause lasts, it increases every second.

#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <optional>
#include <utility>

namespace sonopose::logging {

/// Reports increases of a counter: the first immediately, those of the following minute as one sum. Not
/// thread-safe.
class IncreaseLog {
public:
  static constexpr TimeNs period_ns = 60'000'000'000;

  /// Returns the increase to log now. Call it about once a second.
  std::optional<std::uint64_t> update(std::uint64_t count, SteadyTime now) {
    if (count <= reported_ || (logged_ && now - *logged_ < period_ns)) return std::nullopt;
    logged_ = now;
    return count - std::exchange(reported_, count);
  }

  /// Returns the unlogged increase, at the end of the process.
  std::optional<std::uint64_t> finish(std::uint64_t count) {
    logged_.reset();
    return update(count, {});
  }

private:
  std::uint64_t reported_ = 0;
  std::optional<SteadyTime> logged_;
};

}  // namespace sonopose::logging
