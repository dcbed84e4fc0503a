/// The program sonopose and the common options: --help, --version, suggestions for misspelt words.

#include "support/process.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/text/columns_of.hpp>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace front_door_test {

using namespace sonopose::test;
using Catch::Contains;
namespace fs = std::filesystem;

const std::string version_line =
    " " SONOPOSE_TEST_VERSION " (sonopose::cxx: " SONOPOSE_TEST_CXX_BINDING ")\n";
const fs::path front_door = SONOPOSE_TEST_SONOPOSE;
const std::string prefix = "sonopose-";

/// All programs except sonopose: sonopose-bridge …
std::vector<std::string> programs() {
  std::vector<std::string> names;
  std::istringstream list(SONOPOSE_TEST_PROGRAMS);
  for (std::string name; std::getline(list, name, ',');) {
    if (name.starts_with(prefix)) names.push_back(name);
  }
  return names;
}

fs::path beside_front_door(const std::string& program) {
  return front_door.parent_path() / program;
}

/// Runs a program that must refuse its command line; returns the reason.
std::string refusal(const fs::path& program, const std::vector<std::string>& arguments) {
  const Result result = run(program, arguments);
  CAPTURE(program, arguments, result.error);
  CHECK(result.code.value_or(0) > 0);
  CHECK(result.output.empty());
  return result.error;
}

/// The program sonopose alone in a folder, with a foreign subcommand on PATH.
struct LauncherAlone {
  TemporaryFolder folder;
  fs::path program = folder / "sonopose";
  Environment environment{{"PATH", (folder / "path").string() + ":" + std::getenv("PATH")}};

  LauncherAlone() {
    fs::copy_file(front_door, program);
    fs::create_directory(folder / "path");
    const fs::path verb = folder / "path" / "sonopose-greet";
    write_text(verb, "#!/bin/sh\necho \"hello $*\"\nexit 7\n");
    fs::permissions(verb, fs::perms::owner_all);
  }
};

TEST_CASE("sonopose lists every program with the first sentence of its help") {
  const Result list = run(front_door, {"--help"});
  CHECK(list.code == 0);
  CHECK(run(front_door, {}).output == list.output);
  CHECK(run(front_door, {"help"}).output == list.output);
  REQUIRE(programs().size() >= 12);
  for (const std::string& program : programs()) {
    const std::string help = run(beside_front_door(program), {"--help"}).output;
    const std::string sentence = help.substr(0, help.find('\n'));
    CAPTURE(program, sentence);
    CHECK(sentence.ends_with('.'));
    CHECK_THAT(list.output,
               Contains("  " + program.substr(prefix.size()) + " ") && Contains(" " + sentence + "\n"));
  }
}

TEST_CASE("Every program prints its name and version") {
  const Result front = run(front_door, {"--version"});
  CHECK(front.code == 0);
  CHECK(front.output == "sonopose" + version_line);
  for (const std::string& program : programs()) {
    const Result result = run(beside_front_door(program), {"--version"});
    CAPTURE(program, result.error);
    CHECK(result.code == 0);
    CHECK(result.output == program + version_line);
  }
}

TEST_CASE("Every program takes the arguments of ROS 2 that launch_ros appends") {
  for (const std::string& program : programs()) {
    const Result result = run(beside_front_door(program),
                              {"--ros-args", "-r", "__node:=kart", "-r", "__ns:=/robot", "--", "--version"});
    CAPTURE(program, result.error);
    CHECK(result.code == 0);
    CHECK(result.output == program + version_line);
  }
}

SCENARIO("A verb runs its program") {
  WHEN("the program is beside sonopose") {
    THEN("it gets the arguments, and its exit code is that of sonopose") {
      const Result through = run(front_door, {"simulate", "--list"});
      CHECK(through.code == 0);
      CHECK(through.output == run(beside_front_door("sonopose-simulate"), {"--list"}).output);
      CHECK(run(front_door, {"simulate", "swim"}).code == 1);
    }
    THEN("help VERB is its --help") {
      CHECK(run(front_door, {"help", "replay"}).output ==
            run(beside_front_door("sonopose-replay"), {"--help"}).output);
    }
  }
  WHEN("the program is only on PATH") {
    const LauncherAlone alone;
    THEN("it runs from there") {
      const Result result = run(alone.program, {"greet", "a b", "--c"}, alone.environment);
      CHECK(result.output == "hello a b --c\n");
      CHECK(result.code == 7);
    }
  }
  WHEN("the program of a known verb is missing") {
    const LauncherAlone alone;
    THEN("sonopose says which one") {
      const Result result = run(alone.program, {"tune"}, alone.environment);
      CHECK(result.code.value_or(0) > 0);
      CHECK_THAT(result.error, Contains("sonopose-tune") && Contains("PATH"));
    }
  }
}

TEST_CASE("A misspelt verb is refused with the nearest one") {
  CHECK_THAT(refusal(front_door, {"fussion"}), Contains("fussion: unknown verb; did you mean fusion?"));
  CHECK_THAT(refusal(front_door, {"cal"}), Contains("did you mean calibrate?"));
  CHECK_THAT(refusal(front_door, {"help", "mointor"}), Contains("did you mean monitor?"));
  CHECK_THAT(refusal(front_door, {"--verison"}), Contains("unknown option; did you mean --version?"));
  CHECK_THAT(refusal(front_door, {"../bridge"}), Contains("../bridge: unknown verb"));
  CHECK_THAT(refusal(front_door, {"xyzzy"}), Contains("xyzzy: unknown verb\n"));
}

TEST_CASE("A misspelt option is refused with the nearest one") {
  const auto bridge = beside_front_door("sonopose-bridge");
  CHECK_THAT(refusal(bridge, {"--sorce", "sim"}),
             Contains("sonopose-bridge: --sorce: unknown option; did you mean --source?"));
  CHECK_THAT(refusal(bridge, {"--sorce=sim"}), Contains("--sorce: unknown option; did you mean --source?"));
  CHECK_THAT(refusal(bridge, {"--xyzzy"}), Contains("--xyzzy: unknown option\n"));
  CHECK_THAT(refusal(bridge, {"sim"}), Contains("sim: unexpected argument"));
  // The argument is missing only because of the misspelt option.
  CHECK_THAT(refusal(beside_front_door("sonopose-tune"), {"--vray", "documented.drift.jump_alpha"}),
             Contains("--vray: unknown option; did you mean --vary?"));
}

TEST_CASE("An empty value of an option is not the next word") {
  const auto fusion = beside_front_door("sonopose-fusion");
  CHECK_THAT(refusal(fusion, {"--partition=", "--xyzzy"}), Contains("--xyzzy: unknown option"));
  CHECK_THAT(refusal(fusion, {"--set=", "fusion.engine=kalman"}),
             Contains("fusion.engine=kalman: unexpected"));
}

TEST_CASE("In the journal a mistake on the command line is an error") {
  for (const char* const program : {"fusion", "replay"}) {
    CAPTURE(program);
    const Result result =
        run("/bin/sh", {"-c", R"(JOURNAL_STREAM=$(stat -L -c %d:%i /proc/self/fd/2) exec "$0" --sorce)",
                        beside_front_door(prefix + program).string()});
    CHECK(result.code.value_or(0) > 0);
    CHECK_THAT(result.error, Catch::StartsWith("<3>--sorce: unknown option") &&
                                 Contains("\n<3>  Run sonopose-" + std::string(program) + " --help"));
  }
}

TEST_CASE("In the journal a misspelt verb is an error") {
  const Result result =
      run("/bin/sh",
          {"-c", R"(JOURNAL_STREAM=$(stat -L -c %d:%i /proc/self/fd/2) exec "$0" fussion)", front_door});
  CHECK(result.code == 1);
  CHECK_THAT(result.error,
             Catch::StartsWith("<3>fussion: unknown verb") && Contains("\n<3>  Run sonopose --help"));
}

TEST_CASE("A misspelt command or option of a command is refused with the nearest one") {
  const auto settings = beside_front_door("sonopose-settings");
  CHECK_THAT(refusal(settings, {"rest"}), Contains("rest: unknown command; did you mean reset?"));
  CHECK_THAT(refusal(settings, {"watch", "--jsn"}), Contains("--jsn: unknown option; did you mean --json?"));
  CHECK_THAT(refusal(settings, {"get", "--timout", "1"}), Contains("did you mean --timeout?"));
  CHECK_THAT(refusal(settings, {"--config", "x.toml", "save"}),
             Contains("--config: belongs after save: sonopose-settings save --config …"));
  CHECK_THAT(refusal(beside_front_door("sonopose-mcap"), {"info", "--version"}),
             Contains("--version: belongs before info: sonopose-mcap --version info"));
}

TEST_CASE("Every program refuses an unknown option") {
  for (const std::string& program : programs()) {
    CHECK_THAT(refusal(beside_front_door(program), {"--hlep"}),
               Contains(program + ": --hlep: unknown option; did you mean --help?"));
  }
}

/// Subcommands of a program that have their own help; empty for the program's.
std::vector<std::vector<std::string>> helps_of(const std::string& program) {
  std::vector<std::vector<std::string>> helps{{}};
  if (program == "sonopose-settings")
    helps.insert(helps.end(), {{"get"}, {"set"}, {"watch"}, {"save"}, {"reset"}});
  if (program == "sonopose-security") {
    helps.insert(helps.end(),
                 {{"init"}, {"enclave"}, {"list"}, {"check"}, {"renew"}, {"revoke"}, {"governance"}});
  }
  if (program == "sonopose-calibrate") helps.insert(helps.end(), {{"imu"}, {"allan"}, {"all"}});
  return helps;
}

/// Lines wider than a page.
std::vector<std::string> wide_lines(const std::string& text) {
  std::vector<std::string> wide;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (sonopose::text::columns_of(line) > 100) wide.push_back(line);
  }
  return wide;
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// Descriptions of the options in a help text, by option; wrapped ones are joined.
std::map<std::string, std::string> descriptions_in(const std::string& help) {
  std::map<std::string, std::string> descriptions;
  std::istringstream lines(help);
  std::string option;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string::npos || begin == 0) option.clear();
    if (begin == 2) option = line.substr(2, line.find_first_of(" ,:=", 2) - 2);
    if (option.empty()) continue;
    const std::size_t text = begin == 2 ? line.find("  ", 2) : begin;
    if (text == std::string::npos) continue;
    const std::size_t words = line.find_first_not_of(' ', text);
    std::string& description = descriptions[option];
    description += (description.empty() ? "" : " ") + line.substr(words);
  }
  return descriptions;
}

TEST_CASE("Every help fits a page of 45 lines and 100 columns, and says where it cuts a description") {
  int whole_ones = 0;
  int cut_ones = 0;
  CHECK(lines_in(run(front_door, {}).output) <= 45);
  CHECK(wide_lines(run(front_door, {}).output).empty());
  for (const std::string& program : programs()) {
    for (std::vector<std::string> arguments : helps_of(program)) {
      arguments.emplace_back("--help");
      const Result help = run(beside_front_door(program), arguments);
      CAPTURE(program, arguments, help.output);
      CHECK(help.code == 0);
      CHECK(lines_in(help.output) <= 45);
      CHECK(wide_lines(help.output).empty());
      CHECK_THAT(help.output, !Contains("magnetometer.hard_iron"));
      arguments.back() = "--help-all";
      const Result all = run(beside_front_door(program), arguments);
      CHECK(all.code == 0);
      CHECK(lines_in(all.output) >= lines_in(help.output));
      CHECK(wide_lines(all.output).empty());
      const auto wholes = descriptions_in(all.output);
      for (auto [option, text] : descriptions_in(help.output)) {
        const auto whole = wholes.find(option);
        if (whole == wholes.end()) continue;
        CAPTURE(option, text, whole->second);
        text = text.substr(0, text.find(" (default"));
        const bool is_cut = text.find(" …") != std::string::npos;
        if (!is_cut) CHECK(whole->second.starts_with(text));
        ++(is_cut ? cut_ones : whole_ones);
      }
    }
  }
  CHECK(whole_ones > 100);
  CHECK(cut_ones > 0);
}

TEST_CASE("A help or a version that cannot be written is an error") {
  for (const std::string& program : programs()) {
    for (const char* const option : {"--help", "--version"}) {
      const std::string command = "exec \"$0\" " + std::string(option) + " > /dev/full";
      const Result result = run("/bin/sh", {"-c", command, beside_front_door(program)});
      CAPTURE(program, option, result.error);
      CHECK(result.code.value_or(0) != 0);
      CHECK_THAT(result.error, Contains(program + ": the output cannot be written"));
    }
  }
}

TEST_CASE("The settings have a help of their own") {
  for (const char* const name : {"fusion", "run", "replay", "evaluate", "tune", "attitude"}) {
    const auto program = beside_front_door(prefix + name);
    CAPTURE(program);
    CHECK_THAT(run(program, {"--help"}).output, Contains("--help-settings"));
    const Result all = run(program, {"--help-settings"});
    CHECK(all.code == 0);
    CHECK(lines_in(all.output) > 100);
    CHECK(wide_lines(all.output).empty());
    CHECK_THAT(all.output, Contains("heading.mount_offset_deg") && Contains("calibration.axes"));
  }
  const auto fusion = beside_front_door("sonopose-fusion");
  for (const auto& program : {fusion, beside_front_door("sonopose-replay")}) {  // one with a positional
    const Result group = run(program, {"--help-settings", "documented.attitude.mahony"});
    CHECK(group.code == 0);
    CHECK_THAT(group.output, Contains("documented.attitude.mahony.kp") && !Contains("attitude.ahrs") &&
                                 !Contains("documented.drift."));
  }
  CHECK_THAT(refusal(fusion, {"--help-settings", "headign"}),
             Contains("--help-settings: headign") && Contains("did you mean heading?"));
}

TEST_CASE("Every program suggests the option that a misspelt one resembles") {
  const std::map<std::string, std::pair<std::string, std::string>> misspelt{
      {"run", {"--scenrio", "--scenario"}},        {"bridge", {"--sorce", "--source"}},
      {"fusion", {"--adresses", "--addresses"}},   {"monitor", {"--duraton", "--duration"}},
      {"ros2", {"--fix-mesage", "--fix-message"}}, {"doctor", {"--domian", "--domain"}},
      {"settings", {"--timout", "--timeout"}},     {"simulate", {"--duraton", "--duration"}},
      {"import", {"--postions", "--positions"}},   {"replay", {"--smoth", "--smooth"}},
      {"evaluate", {"--sedes", "--seeds"}},        {"tune", {"--ronds", "--rounds"}},
      {"attitude", {"--filtre", "--filter"}},      {"calibrate", {"--verson", "--version"}},
      {"mavlink", {"--divice", "--device"}},       {"mcap", {"--verson", "--version"}},
      {"record", {"--exlude", "--exclude"}},       {"play", {"--restmp", "--restamp"}},
      {"security", {"--verson", "--version"}},     {"web", {"--lisen", "--listen"}}};
  for (const std::string& program : programs()) {
    const auto found = misspelt.find(program.substr(prefix.size()));
    CAPTURE(program);
    REQUIRE(found != misspelt.end());
    const auto& [wrong, right] = found->second;
    CHECK_THAT(refusal(beside_front_door(program), {wrong, "1"}),
               Contains(fmt::format("{}: {}: unknown option; did you mean {}?", program, wrong, right)));
  }
}

}  // namespace front_door_test
