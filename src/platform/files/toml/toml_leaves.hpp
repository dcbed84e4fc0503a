#pragma once
/// \file
/// Reads the values of a TOML file as one list.

#include "files/error.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace sonopose::files::toml {

/// A date, an array or another value that no file of this project has.
struct OtherValue {};

using Value = std::variant<OtherValue, bool, std::int64_t, double, std::string>;

/// A value and its line. The key joins the names of its tables and its own by dots:
/// "documented.drift.decay_rate_hz".
struct Leaf {
  std::string key;
  Value value;
  std::size_t line = 0;
};

/// Returns all values in the order of their keys. Throws IoError that names file and line if the file cannot
/// be read or is not TOML. Also throws if it has more than 16 MiB, a line more than 32 dots or a key more
/// than 16 parts.
std::vector<Leaf> read_leaves(const std::filesystem::path& file);

/// Returns the value as in a file: texts in quotes.
std::string text_of(const Value& value);

}  // namespace sonopose::files::toml
