#pragma once
/// \file
/// The doctor as a program.

#include "support/bus.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace sonopose::test {

/// Starts the doctor in a neutral environment.
inline std::unique_ptr<Process> start_doctor(std::uint32_t domain_id, Arguments arguments = {}) {
  arguments.insert(arguments.end(), {"--domain", std::to_string(domain_id)});
  return std::make_unique<Process>(SONOPOSE_TEST_DOCTOR, arguments, neutral);
}

/// Waits until it exits.
inline Result result_of(Process& doctor) {
  const auto code = doctor.wait_for_exit();
  return {code, doctor.text(Stream::output), doctor.text(Stream::error)};
}

inline Result look(std::uint32_t domain_id, const Arguments& arguments = {}) {
  return result_of(*start_doctor(domain_id, arguments));
}

/// Runs the doctor, at most ten times, until the report contains this text; returns the last result. On a
/// busy machine, data may not reach it within a short run, and a healthy system may pause.
inline Result look_for(const std::string& text, std::uint32_t domain_id, const Arguments& arguments) {
  Result result;
  for (int i = 0; i < 10 && result.output.find(text) == std::string::npos; ++i) {
    result = look(domain_id, arguments);
  }
  return result;
}

}  // namespace sonopose::test
