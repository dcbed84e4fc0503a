#pragma once
/// \file
/// Names of the fix flags (FixFlag).

#include <sonopose/samples/pose.hpp>

#include <array>
#include <string_view>

namespace sonopose {

struct FixFlagName {
  FixFlag bit;
  std::string_view name;
};

/// Names in ascending order of bits.
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

}  // namespace sonopose
