#pragma once
/// \file
/// An engine's state as a JSON file: every field by name, doubles without loss. Settings are not included.

#include "evaluation/run.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sonopose::evaluation {

/// A state that cannot be saved or restored; the message names the file and the field.
class StateFileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The content of the file. Throws StateFileError for a number that is not finite.
std::string state_text(const SavedState& saved);

/// Parses such content; `name` is the prefix of every error message. Throws StateFileError for invalid JSON,
/// another format or version, or a field that is missing, unknown, of the wrong type or out of range.
SavedState parse_state(std::string_view text, const std::string& name);

/// Save to a file, which is replaced atomically, and load from one. Both also throw files::IoError.
void save_state(const std::filesystem::path& file, const SavedState& saved);
SavedState load_state(const std::filesystem::path& file);

/// Throws StateFileError if `saved`, read from `name`, does not belong to `log`: it has another beacon or
/// another first event.
void check_fits(const SavedState& saved, const recording::SensorLog& log, const std::string& name);

}  // namespace sonopose::evaluation
