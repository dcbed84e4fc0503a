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

namespace sonopose::toml {

/// A date, an array of arrays or another value that no file of this project has.
struct OtherValue {};

/// The words of an array of numbers and texts.
using Words = std::vector<std::string>;

using Value = std::variant<OtherValue, bool, std::int64_t, double, std::string, Words>;

/// A value and its line. The key joins the names of its tables and its own by dots:
/// "documented.drift.decay_rate_hz".
struct Leaf {
  std::string key;
  Value value;
  std::size_t line = 0;
};

/// Returns all values in the order of their keys. Throws files::IoError that names file and line if the file
/// cannot be read or is not TOML. Also throws if it has more than 16 MiB, a line more than 32 dots or a key
/// more than 16 parts.
std::vector<Leaf> read_leaves(const std::filesystem::path& file);

/// Returns the files that together have the values of `file`, in the order in which a value replaces those
/// before it: the file, then the drop-ins FILE.d/*.toml by their names. `except` is a drop-in to leave out.
std::vector<std::filesystem::path> with_drop_ins(const std::filesystem::path& file,
                                                 const std::filesystem::path& except = {});

/// Returns a text about each file in FILE.d that is no drop-in because of its name. Hidden files and those
/// that were drop-ins, such as 50-a.toml.bak, are nobody's mistake.
std::vector<std::string> unread_drop_ins(const std::filesystem::path& file);

/// Returns the value as in a file: texts in quotes.
std::string text_of(const Value& value);

}  // namespace sonopose::toml
