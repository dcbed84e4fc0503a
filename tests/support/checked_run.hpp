#pragma once
/// \file
/// Runs of programs that must succeed, or must fail.

#include "support/process.hpp"

#include <catch2/catch.hpp>

namespace sonopose::test {

/// Runs a program that must succeed. Returns its output.
inline std::string output_of(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                             const Environment& environment = {}) {
  const Result result = run(program, arguments, environment);
  CAPTURE(program, arguments, result.output, result.error);
  REQUIRE(result.code == 0);
  return result.output;
}

/// Runs a program that must end with an error. Returns its message.
inline std::string refusal_of(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                              const Environment& environment = {}) {
  const Result result = run(program, arguments, environment);
  CAPTURE(program, arguments, result.output, result.error);
  REQUIRE(result.code);  // not killed
  CHECK(*result.code > 0);
  return result.error;
}

}  // namespace sonopose::test
