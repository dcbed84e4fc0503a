#pragma once
/// \file
/// An engine's state as a JSON file: every field by name, doubles to the last bit. Settings are no part of
/// it.

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

/// Reads such a text; `name` stands before each error. Throws StateFileError for what is no JSON, another
/// format or version, a field that is missing, unknown, of the wrong kind or impossible.
SavedState parse_state(std::string_view text, const std::string& name);

/// The same with a file, which is replaced once the new one is whole. Throw files::IoError where it cannot be
/// written or read.
void save_state(const std::filesystem::path& file, const SavedState& saved);
SavedState load_state(const std::filesystem::path& file);

/// Throws StateFileError where `saved`, read from `name`, was not left by a run over `log`: another beacon's,
/// or with another first event.
void check_fits(const SavedState& saved, const recording::SensorLog& log, const std::string& name);

}  // namespace sonopose::evaluation
