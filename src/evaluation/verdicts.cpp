#include "evaluation/verdicts.hpp"

#include <bit>

namespace sonopose::evaluation {

std::string verdict_text(std::uint32_t verdict) {
  std::string text;
  for (const VerdictName& entry : verdict_names) {
    if ((verdict & entry.bit) == 0) continue;
    if (!text.empty()) text += '|';
    text += entry.name;
  }
  return text.empty() ? "none" : text;
}

void VerdictCounts::add(std::uint32_t verdict) {
  for (std::size_t i = 0; i < counts_.size(); ++i)
    counts_[i] += (verdict & verdict_names[i].bit) != 0 ? 1U : 0U;
}

std::uint64_t VerdictCounts::of(FixVerdict bit) const {
  static_assert(verdict_names.back().bit == 1U << (verdict_names.size() - 1));  // bit k stands at place k
  return counts_[static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(bit)))];
}

}  // namespace sonopose::evaluation
