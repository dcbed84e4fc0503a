#include "evaluation/replay/search.hpp"

#include "sim/random.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sonopose::evaluation {
namespace {

double number_of(const settings::SettingValue& value) {
  if (const auto* whole = std::get_if<int>(&value)) return *whole;
  return std::get<double>(value);
}

bool is_logarithmic(const Variable& variable) {
  return variable.low > 0.0 && variable.high > 10.0 * variable.low;
}

/// Sets the variable to the value at `position`, 0 to 1, of its range.
void set_at(settings::Settings& settings, const Variable& variable, double position) {
  const double ratio = variable.high / variable.low;
  const double value = is_logarithmic(variable) ? variable.low * std::pow(ratio, position)
                                                : variable.low + (variable.high - variable.low) * position;
  const bool whole = std::holds_alternative<int>(settings::get(settings, variable.key));
  if (whole) {
    settings::set(settings, variable.key, static_cast<int>(std::lround(value)));
  } else {
    settings::set(settings, variable.key, std::clamp(value, variable.low, variable.high));
  }
}

double position_in_range(const settings::Settings& settings, const Variable& variable) {
  const double value =
      std::clamp(number_of(settings::get(settings, variable.key)), variable.low, variable.high);
  if (is_logarithmic(variable)) {
    return std::log(value / variable.low) / std::log(variable.high / variable.low);
  }
  return variable.high > variable.low ? (value - variable.low) / (variable.high - variable.low) : 0.0;
}

/// Clamps values to their bounds. Values within the bounds keep every bit.
settings::Settings within(settings::Settings settings, const std::vector<Variable>& variables) {
  for (const Variable& variable : variables) {
    const double value = number_of(settings::get(settings, variable.key));
    if (value < variable.low) set_at(settings, variable, 0.0);
    if (value > variable.high) set_at(settings, variable, 1.0);
  }
  return settings;
}

}  // namespace

Variable variable_of(std::string_view text) {
  const auto equals = text.find('=');
  Variable variable{.key = std::string(text.substr(0, equals))};
  const settings::SettingInfo& row = settings::setting_info(variable.key);
  if (!row.choices.empty() || std::holds_alternative<bool>(row.initial)) {
    throw settings::SettingError(fmt::format("{}: is not a number and cannot be searched", variable.key));
  }
  variable.low = number_of(row.minimum);
  variable.high = number_of(row.maximum);
  if (equals == std::string_view::npos) return variable;

  const std::string_view range = text.substr(equals + 1);
  const auto dots = range.find("..");
  if (dots == std::string_view::npos) {
    throw settings::SettingError(fmt::format("{}: expected LOW..HIGH, found \"{}\"", variable.key, range));
  }
  const double low = number_of(settings::parse_value(variable.key, range.substr(0, dots)));
  const double high = number_of(settings::parse_value(variable.key, range.substr(dots + 2)));
  if (!(low < high)) {
    throw settings::SettingError(fmt::format("{} = {}: LOW must be below HIGH", variable.key, range));
  }
  if (!(low >= variable.low && high <= variable.high)) {
    throw settings::SettingError(
        fmt::format("{} = {}: allowed are bounds within {}", variable.key, range, row.allowed()));
  }
  variable.low = low;
  variable.high = high;
  return variable;
}

Found search(const settings::Settings& start, const std::vector<Variable>& variables,
             const std::function<double(const settings::Settings&)>& cost, int rounds, std::uint64_t seed,
             const std::function<void(int, const Found&)>& on_better,
             const std::function<bool(int)>& goes_on) {
  sim::Random random(seed);
  std::vector<double> best;
  for (const Variable& variable : variables) best.push_back(position_in_range(start, variable));
  const settings::Settings begin = within(start, variables);
  Found found{begin, cost(begin)};
  constexpr double max_step = 0.35;
  constexpr double min_step = 0.03;
  for (int round = 0; round < rounds && !variables.empty() && goes_on(round); ++round) {
    const double step = max_step + (min_step - max_step) * round / rounds;
    std::vector<double> positions = best;
    const int changes = 1 + static_cast<int>(3.0 * random.uniform());
    for (int i = 0; i < changes; ++i) {
      double& position =
          positions[static_cast<std::size_t>(random.uniform() * static_cast<double>(positions.size()))];
      position = std::clamp(position + step * (2.0 * random.uniform() - 1.0), 0.0, 1.0);
    }
    settings::Settings candidate = begin;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (positions[i] != position_in_range(begin, variables[i]))
        set_at(candidate, variables[i], positions[i]);
    }
    const double candidate_cost = cost(candidate);
    if (!(candidate_cost < found.cost)) continue;
    best = positions;
    found = {candidate, candidate_cost};
    on_better(round, found);
  }
  return found;
}

}  // namespace sonopose::evaluation
