#pragma once
/// \file
/// A random search for better settings: simple, and it finds what a person would not try.

#include <sonopose/settings/settings_table.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::evaluation {

/// A setting that the search may change, and how far.
struct Variable {
  std::string key;
  double low = 0;
  double high = 0;
};

/// Reads `group.key=LOW..HIGH`, or `group.key` for the setting's whole range. Throws settings::SettingError
/// where the key is unknown or no number, or the bounds are not within its range.
Variable variable_of(std::string_view text);

struct Found {
  settings::Settings settings;
  double cost = 0;
};

/// Begins at `start`, moved into the bounds where it lies outside them, changes a few of the variables at
/// random and keeps what costs less; the steps become smaller from round to round. Ranges of more than a
/// decade are searched on a logarithmic scale. The same seed gives the same search. `on_better(round, found)`
/// hears of each improvement.
Found search(const settings::Settings& start, const std::vector<Variable>& variables,
             const std::function<double(const settings::Settings&)>& cost, int rounds, std::uint64_t seed,
             const std::function<void(int, const Found&)>& on_better);

}  // namespace sonopose::evaluation
