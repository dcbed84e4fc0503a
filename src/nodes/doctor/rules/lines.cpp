#include "doctor/rules/checks.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

namespace sonopose::doctor::rules {
namespace {

/// The finding of one line.
Finding finding_of(const LineStatus& line) {
  const std::string subject = "line " + line.name;
  switch (line.state) {
    case LineState::waiting:
      return {Severity::warning, subject, fmt::format("its bridge waits for the device: {}", line.text),
              "plug the device in, or correct the --device of the bridge"};
    case LineState::failed:
      return {Severity::error, subject, fmt::format("cannot be used: {}", line.text),
              "correct the cause, and start the bridge again if it has ended"};
    case LineState::silent:
      return {Severity::warning, subject, line.text, {}};
    case LineState::no_frames:
      return {Severity::error, subject, line.text, {}};
    case LineState::closed:
    case LineState::open:
      break;
  }
  return {Severity::ok, subject, text::count_text(line.frames, "frame") + " received", {}};
}

}  // namespace

void check_lines(const Observations& observations, Findings& findings) {
  for (const LineStatus& line : observations.lines) findings.push_back(finding_of(line));
}

}  // namespace sonopose::doctor::rules
