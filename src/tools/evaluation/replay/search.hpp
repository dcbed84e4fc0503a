#pragma once
/// \file
/// A random search for better settings.

#include <sonopose/settings/settings_table.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::evaluation {

/// A setting that the search may change, and its bounds.
struct Variable {
  std::string key;
  double low = 0;
  double high = 0;
};

/// Parses `group.key=LOW..HIGH`, or `group.key` for the setting's whole range. Throws settings::SettingError
/// if the key is unknown or not numeric, or if the bounds are outside its range.
Variable variable_of(std::string_view text);

struct Found {
  settings::Settings settings;
  double cost = 0;
};

/// Starts at `start`, clamped to the bounds. Changes a few random variables per round and keeps changes that
/// reduce the cost. The steps shrink from round to round. Ranges of more than a decade are searched on a
/// logarithmic scale. The same seed gives the same search. Calls `on_better(round, found)` for each
/// improvement, and `goes_on(round)` before each round, which ends the search by returning false.
Found search(
    const settings::Settings& start, const std::vector<Variable>& variables,
    const std::function<double(const settings::Settings&)>& cost, int rounds, std::uint64_t seed,
    const std::function<void(int, const Found&)>& on_better,
    const std::function<bool(int)>& goes_on = [](int) { return true; });

}  // namespace sonopose::evaluation
