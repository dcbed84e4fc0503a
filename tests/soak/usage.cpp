#include "soak/usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace sonopose::soak {
namespace {

/// Rise of the smallest value from the first to the last quarter.
int growth(std::span<const Usage> usages, int Usage::*number) {
  const auto least = [number](std::span<const Usage> part) {
    int fewest = part.front().*number;
    for (const Usage& usage : part) fewest = std::min(fewest, usage.*number);
    return fewest;
  };
  const std::size_t quarter = std::max<std::size_t>(1, usages.size() / 4);
  return least(usages.last(quarter)) - least(usages.first(quarter));
}

std::span<const Usage> settled(std::span<const Usage> usages) {
  const double from_s = usages.empty() ? 0 : std::min(settling_s, usages.back().time_s / 3);
  const auto first = std::find_if(usages.begin(), usages.end(),
                                  [from_s](const Usage& usage) { return usage.time_s >= from_s; });
  return usages.subspan(static_cast<std::size_t>(first - usages.begin()));
}

}  // namespace

Usage usage_of(int pid, double time_s) {
  const std::filesystem::path folder = "/proc/" + std::to_string(pid);
  Usage usage{.time_s = time_s};
  std::ifstream status(folder / "status");
  for (std::string word; status >> word;) {
    if (word == "VmRSS:") status >> usage.resident_kb;
    if (word == "Threads:") status >> usage.threads;
  }
  if (usage.threads == 0 || usage.resident_kb == 0) {
    throw std::runtime_error(folder.string() + "/status: the process does not run");
  }
  const std::filesystem::directory_iterator descriptors(folder / "fd");
  usage.descriptors = static_cast<int>(std::distance(begin(descriptors), end(descriptors)));
  return usage;
}

Growth growth_of(std::span<const Usage> usages) {
  const auto count = static_cast<double>(usages.size());
  if (usages.size() < 3) return {};
  double mean_s = 0;
  double mean_kb = 0;
  for (const Usage& usage : usages) {
    mean_s += usage.time_s / count;
    mean_kb += usage.resident_kb / count;
  }
  double time_square = 0;
  double product = 0;
  double kb_square = 0;
  for (const Usage& usage : usages) {
    time_square += (usage.time_s - mean_s) * (usage.time_s - mean_s);
    product += (usage.time_s - mean_s) * (usage.resident_kb - mean_kb);
    kb_square += (usage.resident_kb - mean_kb) * (usage.resident_kb - mean_kb);
  }
  const double slope = product / time_square;
  const double residual = std::max(0.0, kb_square - slope * product) / (count - 2);
  const double scale = 100.0 * 3600.0 / mean_kb;
  return {slope * scale, std::sqrt(residual / time_square) * scale};
}

Judgement judge(const std::string& name, std::span<const Usage> usages) {
  Judgement judgement;
  const auto judged = settled(usages);
  if (judged.empty()) {
    judgement.violations.push_back(name + ": nothing was measured");
    return judgement;
  }
  judgement.growth = growth_of(judged);
  for (const Usage& usage : judged) {
    judgement.resident_mb += usage.resident_kb / 1024 / static_cast<double>(judged.size());
  }
  judgement.more_descriptors = growth(judged, &Usage::descriptors);
  judgement.more_threads = growth(judged, &Usage::threads);
  if (judgement.more_descriptors > 0) {
    judgement.violations.push_back(fmt::format("{}: {} more descriptors", name, judgement.more_descriptors));
  }
  if (judgement.more_threads > 0) {
    judgement.violations.push_back(fmt::format("{}: {} more threads", name, judgement.more_threads));
  }
  if (usages.back().time_s >= min_judged_s && judgement.growth.percent_per_hour >= max_percent_per_hour) {
    judgement.violations.push_back(fmt::format("{}: memory grows by {:.2f} % an hour; the limit is {:.0f} %",
                                               name, judgement.growth.percent_per_hour,
                                               max_percent_per_hour));
  }
  return judgement;
}

}  // namespace sonopose::soak
