#include "evaluation/score/fix_flag_counts.hpp"

#include <bit>

namespace sonopose::evaluation {

std::string fix_flag_text(std::uint32_t flags) {
  std::string text;
  for (const FixFlagName& entry : fix_flag_names) {
    if ((flags & entry.bit) == 0) continue;
    if (!text.empty()) text += '|';
    text += entry.name;
  }
  return text.empty() ? "none" : text;
}

void FixFlagCounts::add(std::uint32_t flags) {
  for (std::size_t i = 0; i < counts_.size(); ++i)
    counts_[i] += (flags & fix_flag_names[i].bit) != 0 ? 1U : 0U;
}

std::uint64_t FixFlagCounts::of(FixFlag bit) const {
  static_assert(fix_flag_names.back().bit == 1U << (fix_flag_names.size() - 1));  // bit k has index k
  return counts_[static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(bit)))];
}

}  // namespace sonopose::evaluation
