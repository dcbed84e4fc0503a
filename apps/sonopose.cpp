// sonopose: starts the other programs; `sonopose VERB ARGUMENTS…` executes sonopose-VERB.

#include "launch/execute.hpp"
#include "logging/log.hpp"
#include "support/output.hpp"
#include "support/verbs.hpp"
#include "support/version.hpp"
#include <sonopose/text/nearest.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace sonopose::apps;

constexpr int failed = 1;

/// Flushes the output. Returns the exit code.
int end_of_output() try {
  flush_output();
  return 0;
} catch (const std::runtime_error& error) {
  sonopose::logging::failure(error.what());
  return failed;
}

int list_verbs() {
  sonopose::apps::print(
      "Fuses an IMU and ultrasonic beacons into a pose, on DDS.\n"
      "Usage: sonopose VERB [ARGUMENTS...]\n\nVerbs:\n");
  for (const Verb& verb : verbs) sonopose::apps::print("  {:<11}{}\n", verb.name, verb.description);
  sonopose::apps::print(
      "\nOptions:\n"
      "  -h,--help  Print this list and exit; sonopose help VERB shows the options of a verb\n"
      "  --version  Print the version and exit\n");
  return end_of_output();
}

int refuse(const std::string& what) {
  sonopose::logging::failure(what + "\nRun sonopose --help for all verbs.");
  return failed;
}

bool is_known(const std::string& verb) {
  return std::any_of(verbs.begin(), verbs.end(), [&](const Verb& each) { return each.name == verb; });
}

int refuse_verb(const std::string& verb) {
  if (is_known(verb)) {
    return refuse(fmt::format("sonopose-{} is neither beside this program nor on PATH", verb));
  }
  std::vector<std::string> names(verbs.size());
  std::transform(verbs.begin(), verbs.end(), names.begin(), [](const Verb& each) { return each.name; });
  return refuse(fmt::format("{}: unknown verb{}", verb, sonopose::text::suggestion(verb, names)));
}

/// Replaces this process by the program of the verb. Returns only on failure.
int become(const std::string& verb, const std::vector<std::string>& arguments) {
  if (verb.empty() || verb.find('/') != std::string::npos) return refuse_verb(verb);
  const std::string program = "sonopose-" + verb;
  sonopose::launch::execute(program, arguments);
  if (errno == ENOENT) return refuse_verb(verb);
  return refuse(fmt::format("{} cannot be started: {}", program, std::strerror(errno)));
}

}  // namespace

int main(int argc, char** argv) {
  sonopose::logging::set_program("sonopose");
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.empty()) return list_verbs();
  const std::string first = words.front();
  words.erase(words.begin());
  if (first == "--version") {
    sonopose::apps::print("sonopose {}\n", version_text());
    return end_of_output();
  }
  if (first == "help" && !words.empty()) return become(words.front(), {"--help"});
  if (first == "help" || first == "--help" || first == "-h") return list_verbs();
  if (first.starts_with('-')) {
    return refuse(fmt::format("{}: unknown option{}", first,
                              sonopose::text::suggestion(first, {"--help", "--version"})));
  }
  return become(first, words);
}
