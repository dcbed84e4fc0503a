#pragma once
// Checks of the texts of options.

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace sonopose::apps {

/// A check of the text of an option.
struct Check {
  /// Says what is wrong with the text; empty if nothing is. May replace the text.
  std::function<std::string(std::string&)> mistake_in;
  std::string allowed;  ///< follows the type in --help: "[0 - 1]" or "{on,off}"
};

/// Accepts a number in this range. Unlike CLI11's own check, refuses texts that are not numbers, such as nan,
/// and -1 for an unsigned number.
Check number_between(double min, double max = std::numeric_limits<double>::max());

/// Replaces a size with a unit, such as 0.5MB, 2 GiB or 1e6, by its number of bytes, which must be in this
/// range. 1 kB is 1000 bytes.
Check size_between(double min_bytes, double max_bytes = 1e18);

/// Accepts a text, or the name of a file, that `read` reads without an exception.
Check readable_by(std::function<void(const std::string&)> read);

/// Accepts only these words; its error lists them.
Check one_of(const std::vector<std::string>& words);

}  // namespace sonopose::apps
