#pragma once
/// \file
/// Messages of a file as lines of JSON, by our reader and by third-party decoders: @mcap/core and
/// @foxglove/omgidl-serialization, found through NODE_PATH.

#include "bus_log/messages.hpp"
#include "support/process.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace sonopose::test {

inline bool has_node_packages(const std::string& packages) {
  try {
    return run("/usr/bin/env", {"node", "-e", packages}).code == 0;
  } catch (const std::system_error&) {
    return false;
  }
}

inline bool has_foreign_decoders() {
  return has_node_packages(
      "require('@mcap/core'); require('@foxglove/omgidl-parser'); "
      "require('@foxglove/omgidl-serialization')");
}

inline bool has_foreign_decompressors() {
  return has_node_packages("require('@mcap/support')");
}

inline constexpr const char* no_foreign_decoders =
    "skipped: no node with Foxglove's packages; npm install @mcap/core @mcap/support @foxglove/omgidl-parser "
    "@foxglove/omgidl-serialization, and set NODE_PATH=$PWD/node_modules\n";

inline std::vector<std::string> our_lines(const std::filesystem::path& file) {
  const mcap::Reader reader(file);
  bus_log::ChosenMessages messages(reader, {});
  std::vector<std::string> lines;
  while (const auto chosen = messages.next())
    lines.push_back(bus_log::json_of(*chosen->channel, chosen->message));
  return lines;
}

/// Compares JSON values; JavaScript prints a float with more digits than we do.
inline bool same(const nlohmann::json& a, const nlohmann::json& b) {
  if (a.is_number_float() || b.is_number_float()) {
    const double difference = std::abs(a.get<double>() - b.get<double>());
    return difference <= 1e-7 * std::abs(a.get<double>());
  }
  if (a.is_structured()) {
    if (a.size() != b.size() || a.type() != b.type()) return false;
    for (const auto& item : a.items()) {
      if (a.is_object() && !b.contains(item.key())) return false;
      if (!same(item.value(), a.is_object() ? b.at(item.key()) : b.at(std::stoul(item.key())))) return false;
    }
    return true;
  }
  return a == b;
}

/// Checks that both decoders agree and returns the number of lines.
inline std::size_t check_foreign_lines(const std::filesystem::path& file) {
  const auto ours = our_lines(file);
  const Result theirs =
      run("/usr/bin/env", {"node", SONOPOSE_SOURCE_DIR "/tests/interop/mcap_lines.cjs", file.string()});
  CAPTURE(theirs.error);
  REQUIRE(theirs.code == 0);
  std::istringstream lines(theirs.output);
  std::string line;
  for (const std::string& our_line : ours) {
    REQUIRE(std::getline(lines, line));
    CAPTURE(our_line, line);
    CHECK(same(nlohmann::json::parse(our_line), nlohmann::json::parse(line)));
  }
  CHECK_FALSE(std::getline(lines, line));
  return ours.size();
}

}  // namespace sonopose::test
