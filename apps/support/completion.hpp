#pragma once
// Completions for shells, from the declarations of the options.

#include <CLI/CLI.hpp>

#include <string>

namespace sonopose::apps {

/// Adds the hidden flag --print-completions, which the scripts in share/completions read.
void add_completions(CLI::App& app);

/// Returns one line for each option and command: COMMAND, WORD, VALUES and description, separated by tabs.
/// COMMAND is "-" for the program itself; VALUES is "-" for a flag, "FILE", "DIR", the allowed words with |
/// between them, or the name of another type.
std::string completions(const CLI::App& app);

}  // namespace sonopose::apps
