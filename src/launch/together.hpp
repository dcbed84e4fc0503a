#pragma once
/// \file
/// Runs several programs that are started and ended together.

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::launch {

/// Where the programs without the terminal write their errors.
enum class ErrorOutput : std::uint8_t {
  pass_on,  ///< to the standard error of this process
  keep,     ///< the latest lines are printed at the end: for programs behind a full screen
};

struct Program {
  std::string name;  ///< as execute() takes it
  std::vector<std::string> arguments;
  bool has_terminal = false;  ///< it gets this process's standard input and standard error as they are
};

/// Starts the programs. As soon as one ends, or this process gets SIGINT, SIGTERM or SIGHUP, it sends SIGTERM
/// to the others and waits for them; it kills what has not ended after 10 s, or at another signal more than a
/// second after the first. A program that has the terminal gets another SIGTERM before, and a second to
/// restore the terminal. Logs which program ended with an error. If this process is killed, the programs get
/// SIGTERM, except those whose files have capabilities (prctl(2)).
///
/// Returns 0 if all ended with exit code 0 or by the request to end; otherwise the exit code of the first one
/// that failed, or 128 + the number of the signal that killed it. Throws std::system_error if no program can
/// be started. To be called on the only thread of the process.
int run_together(const std::vector<Program>& programs, ErrorOutput output);

}  // namespace sonopose::launch
