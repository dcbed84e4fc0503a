#pragma once
/// \file
/// Recognises the first report on each fix, where its fusion is not known.

#include <sonopose/samples/pose.hpp>
#include <sonopose/samples/samples.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace sonopose::observation {

/// Reports of one beacon, one for each fix however many fusions report on it. Does not allocate.
class FirstReports {
public:
  /// True for the first report on a fix.
  bool accepts(const FixReport& report) noexcept {
    const Fix fix{report.sequence, report.emission_time_ns};
    if (std::find(latest_.begin(), latest_.end(), fix) != latest_.end()) return false;
    latest_[next_] = fix;
    next_ = (next_ + 1) % latest_.size();
    return true;
  }

private:
  struct Fix {
    std::uint64_t sequence = 0;
    TimeNs emission_time_ns = 0;
    bool operator==(const Fix&) const = default;
  };

  std::array<Fix, 32> latest_{};  ///< ring buffer: more than a second of fixes
  std::size_t next_ = 0;
};

}  // namespace sonopose::observation
