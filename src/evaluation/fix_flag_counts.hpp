#pragma once
/// \file
/// Names and counts of fix flags (FixFlag).

#include <sonopose/samples/pose.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace sonopose::evaluation {

struct FixFlagName {
  FixFlag bit;
  std::string_view name;
};

/// In ascending order of bits.
inline constexpr std::array<FixFlagName, 11> fix_flag_names{{{fix_used, "used"},
                                                             {fix_outlier, "outlier"},
                                                             {fix_low_quality, "low_quality"},
                                                             {fix_invalid, "invalid"},
                                                             {fix_stuck_forced, "stuck_forced"},
                                                             {fix_snapped_over, "snapped_over"},
                                                             {fix_snapped_under, "snapped_under"},
                                                             {fix_stale_recovered, "stale_recovered"},
                                                             {fix_frozen, "frozen"},
                                                             {fix_first, "first"},
                                                             {fix_too_late, "too_late"}}};

/// The names of all set bits, joined by `|`; "none" if no bit is set.
std::string fix_flag_text(std::uint32_t flags);

/// Whether a fix was used with less weight because its innovation is large. The weight of the documented
/// engine falls with every innovation, so there it must be an outlier.
bool is_down_weighted(const FixReport& report);

/// Counts how often each flag was set.
class FixFlagCounts {
public:
  void add(std::uint32_t flags);
  [[nodiscard]] std::uint64_t of(FixFlag bit) const;

private:
  std::array<std::uint64_t, fix_flag_names.size()> counts_{};
};

}  // namespace sonopose::evaluation
