#pragma once
/// \file
/// Saves the state of an estimator as a JSON file: every field by name, doubles to the last bit. It does not
/// contain settings.

#include "evaluation/replay/run.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sonopose::evaluation {

/// An error of saving or restoring a state. The message names the file and the field.
class StateFileError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// Writes the file's text. Throws StateFileError for a number that is not finite.
std::string state_text(const SavedState& saved);

/// Parses such a text; `name` is the prefix of each error. Throws StateFileError if the text is not JSON, or
/// is of another format or version. Also throws if a field is missing, unknown, of the wrong type or
/// impossible.
SavedState parse_state(std::string_view text, const std::string& name);

/// Save and load a file, which is replaced atomically. Throw files::IoError if it cannot be written or read.
void save_state(const std::filesystem::path& file, const SavedState& saved);
SavedState load_state(const std::filesystem::path& file);

/// Throws StateFileError if `saved`, read from `name`, does not belong to a run over `log`: another beacon,
/// or another first event.
void check_fits(const SavedState& saved, const recording::SensorLog& log, const std::string& name);

}  // namespace sonopose::evaluation
