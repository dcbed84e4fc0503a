#pragma once
/// \file
/// The verdicts on a fix (FixVerdict) in words.

#include <sonopose/samples/pose.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace sonopose::evaluation {

struct VerdictName {
  FixVerdict bit;
  std::string_view name;
};

/// In ascending order of the bits.
inline constexpr std::array<VerdictName, 10> verdict_names{{{verdict_used, "used"},
                                                            {verdict_outlier, "outlier"},
                                                            {verdict_low_quality, "low_quality"},
                                                            {verdict_invalid, "invalid"},
                                                            {verdict_stuck_forced, "stuck_forced"},
                                                            {verdict_snapped_over, "snapped_over"},
                                                            {verdict_snapped_under, "snapped_under"},
                                                            {verdict_stale_recovered, "stale_recovered"},
                                                            {verdict_frozen, "frozen"},
                                                            {verdict_first, "first"}}};

/// The names of all bits that are set, joined by `|`; "none" where none is.
std::string verdict_text(std::uint32_t verdict);

/// How often each verdict was given, in the order of `verdict_names`.
class VerdictCounts {
public:
  void add(std::uint32_t verdict);
  [[nodiscard]] std::uint64_t of(FixVerdict bit) const;

private:
  std::array<std::uint64_t, verdict_names.size()> counts_{};
};

}  // namespace sonopose::evaluation
