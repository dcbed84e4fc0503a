#pragma once
/// \file
/// Runs several programs that start and end together.

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::launch {

/// The destination of the errors of programs without the terminal.
enum class ErrorOutput : std::uint8_t {
  pass_on,  ///< the standard error of this process
  keep,     ///< latest lines, printed at the end: for programs behind a full screen
};

struct Program {
  std::string name;  ///< name as for execute()
  std::vector<std::string> arguments;
  bool has_terminal = false;  ///< shares standard input and standard error with this process
};

/// Starts the programs. As soon as one ends, or this process gets SIGINT, SIGTERM, SIGHUP or SIGXCPU, it
/// sends SIGTERM to the others and waits for them. It kills those that have not ended after 10 s, or at
/// another signal, except SIGXCPU, more than a second after the first. A program with the terminal first gets
/// another SIGTERM, and a second to restore the terminal. Logs which program ended with an error. If this
/// process is killed, the programs get SIGTERM, except those whose files have capabilities (prctl(2)).
///
/// Returns 0 if all ended with exit code 0 or on request. Otherwise returns the exit code of the first one
/// that failed, or 128 + the number of the signal that killed it. Throws std::system_error if no program can
/// be started. Call it on the only thread of the process.
int run_together(const std::vector<Program>& programs, ErrorOutput output);

}  // namespace sonopose::launch
