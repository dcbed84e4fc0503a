#pragma once
/// \file
/// Counts fix flags (FixFlag).

#include <sonopose/samples/fix_flag_names.hpp>

#include <array>
#include <cstdint>
#include <string>

namespace sonopose::evaluation {

/// Returns the names of all set bits, joined by `|`; "none" if no bit is set.
std::string fix_flag_text(std::uint32_t flags);

/// Counts how often each flag was set.
class FixFlagCounts {
public:
  void add(std::uint32_t flags);
  [[nodiscard]] std::uint64_t of(FixFlag bit) const;

private:
  std::array<std::uint64_t, fix_flag_names.size()> counts_{};
};

}  // namespace sonopose::evaluation
