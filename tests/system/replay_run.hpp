#pragma once
/// \file
/// Runs sonopose-replay on a recording of its own.

#include "recording/log_writer.hpp"
#include "sim/simulator.hpp"
#include "support/checked_run.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace replay_run {

using namespace sonopose;
using namespace sonopose::test;

/// A folder with the recording `log`: 12 s of a scenario.
class Recording {
public:
  explicit Recording(bool with_truth = true) {
    sim::Simulator simulator(sim::find_scenario("outlier_bursts"), {.duration_s = 12.0});
    recording::SensorLogWriter writer(log());
    while (const auto step = simulator.next()) {
      writer.write(step->event);
      if (with_truth && step->truth) writer.write(*step->truth);
    }
    writer.flush();
  }

  [[nodiscard]] std::string log() const { return (folder_ / "log").string(); }
  std::filesystem::path operator/(const char* name) const { return folder_ / name; }

  /// Appends a row to a file.
  void append(const char* file, const std::string& row) const {
    const auto path = std::filesystem::path(log()) / file;
    write_text(path, read_text(path) + row + "\n");
  }

private:
  TemporaryFolder folder_;
};

inline Result replay(const std::vector<std::string>& arguments, const Environment& environment = {}) {
  return run(SONOPOSE_TEST_REPLAY, arguments, environment);
}

inline nlohmann::json report_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  return nlohmann::json::parse(output_of(SONOPOSE_TEST_REPLAY, arguments));
}

/// Runs the program with arguments that it must refuse; returns the message.
inline std::string refusal(const std::vector<std::string>& arguments, const Environment& environment = {}) {
  return refusal_of(SONOPOSE_TEST_REPLAY, arguments, environment);
}

}  // namespace replay_run
