#pragma once
/// \file
/// The state of an estimator as a JSON file: every field by name, doubles to the last bit. It does not
/// contain settings.

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

/// The file's text. Throws StateFileError for a number that is not finite.
std::string state_text(const SavedState& saved);

/// Reads such a text; `name` is the prefix of each error. Throws StateFileError if the text is not JSON, if
/// it is of another format or version, or if a field is missing, unknown, of the wrong type or impossible.
SavedState parse_state(std::string_view text, const std::string& name);

/// The same with a file, which is replaced atomically. Throw files::IoError if it cannot be written or read.
void save_state(const std::filesystem::path& file, const SavedState& saved);
SavedState load_state(const std::filesystem::path& file);

/// Throws StateFileError if `saved`, read from `name`, is not of a run over `log`: of another beacon, or with
/// another first event.
void check_fits(const SavedState& saved, const recording::SensorLog& log, const std::string& name);

}  // namespace sonopose::evaluation
