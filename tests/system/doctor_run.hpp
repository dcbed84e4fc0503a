#pragma once
/// \file
/// The doctor as a program.

#include "support/bus.hpp"

#include <chrono>
#include <cstdint>
#include <string>

namespace sonopose::test {

/// Runs the doctor until it exits; the environment is neutral but for `changes`.
inline Result doctor(std::uint32_t domain_id, Arguments arguments = {}, const Environment& changes = {}) {
  arguments.insert(arguments.end(), {"--domain", std::to_string(domain_id)});
  Environment environment = neutral;
  for (const auto& [name, value] : changes) environment[name] = value;
  Process process(SONOPOSE_TEST_DOCTOR, arguments, environment);
  const auto code = process.wait_for_exit(std::chrono::seconds(90));  // fits beside many processes
  return {code, process.text(Stream::output), process.text(Stream::error)};
}

}  // namespace sonopose::test
