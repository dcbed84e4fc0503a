/// The dependency rules between modules (docs/architecture.md, "Modules"). A module is a folder under src/
/// with its public headers under include/sonopose/. It may include only itself and what its CMakeLists.txt
/// lists. The include path makes every header reachable from everywhere, so the compiler alone does not
/// enforce this.

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace dependencies_test {

namespace fs = std::filesystem;
using Names = std::set<std::string>;
using Breaches = std::vector<std::string>;
const Breaches none;

const fs::path root = SONOPOSE_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> matches_of(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    found.push_back((*match)[1]);
  }
  return found;
}

std::vector<fs::path> sources_in(const fs::path& folder, bool recursive) {
  std::vector<fs::path> found;
  if (!fs::exists(folder)) return found;
  const auto add = [&found](const fs::directory_entry& entry) {
    if (entry.path().extension() == ".hpp" || entry.path().extension() == ".cpp")
      found.push_back(entry.path());
  };
  if (recursive) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) add(entry);
  } else {
    for (const auto& entry : fs::directory_iterator(folder)) add(entry);
  }
  return found;
}

/// What stands between the brackets or quotes of an #include.
std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex directive(R"(#\s*include\s*[<"]([^>"]+)[>"])");
  return matches_of(text_of(file), directive);
}

std::string target_name(std::string folder) {
  std::replace(folder.begin(), folder.end(), '/', '_');
  return folder;
}

/// One folder under src/ that declares a module.
struct Module {
  std::string folder;  ///< "dds/binding"
  Names uses;          ///< targets it may use: "samples", "dds_binding", "idl"

  [[nodiscard]] std::vector<fs::path> sources() const {
    std::vector<fs::path> found = sources_in(root / "src" / folder, false);
    const auto headers = sources_in(root / "include/sonopose" / folder, false);
    found.insert(found.end(), headers.begin(), headers.end());
    return found;
  }
};

std::map<std::string, Module> read_modules() {
  static const std::regex declaration(R"(sonopose_module\(\s*(\w+))");
  static const std::regex used(R"(sonopose::(\w+))");
  std::map<std::string, Module> modules;
  for (const auto& entry : fs::recursive_directory_iterator(root / "src")) {
    if (entry.path().filename() != "CMakeLists.txt") continue;
    const std::string text = text_of(entry.path());
    const auto names = matches_of(text, declaration);
    if (names.empty()) continue;
    const std::string folder = fs::relative(entry.path().parent_path(), root / "src").string();
    CAPTURE(folder);
    REQUIRE(names == std::vector{target_name(folder)});  // one folder, one target
    const auto uses = matches_of(text, used);
    modules[folder] = {folder, Names(uses.begin(), uses.end())};
  }
  return modules;
}

const std::map<std::string, Module>& modules() {
  static const auto all = read_modules();
  return all;
}

/// The target that a header of ours belongs to; empty for other headers. `own` is the includer's folder.
std::string target_of(const std::string& header) {
  if (header.starts_with("sonopose/idl/ros2/")) return "ros2_idl";
  if (header.starts_with("sonopose/idl/")) return "idl";
  const bool is_public = header.starts_with("sonopose/");
  const std::string path = is_public ? header.substr(std::string("sonopose/").size()) : header;
  const std::string folder = fs::path(path).parent_path().string();
  if (is_public) return target_name(folder);
  return modules().contains(folder) ? target_name(folder) : "";
}

std::string place(const fs::path& file, const std::string& what) {
  return fs::relative(file, root).string() + ": " + what;
}

// System headers by what they give access to.
const std::string dds_headers = R"(dds/.*|ddsc/.*|sonopose/idl/.*)";
const std::string file_headers = R"(fstream|filesystem|cstdio|stdio\.h|fcntl\.h|sys/stat\.h)";
const std::string socket_headers =
    R"(sys/socket\.h|netinet/.*|arpa/.*|asio.*|poll\.h|sys/socket\.h|termios\.h)";
const std::string clock_headers = R"(chrono|ctime|time\.h|sys/time\.h)";
const std::string thread_headers =
    R"(thread|mutex|shared_mutex|condition_variable|atomic|future|stop_token|semaphore)";
const std::string logging_headers = R"(iostream|ostream|fmt/.*|spdlog/.*|print)";
const std::string command_line_headers = R"(CLI/.*|getopt\.h|argp\.h)";

/// Modules that share a rule about the world outside, and the headers that they must not include.
struct Restriction {
  std::string what;
  Names folders;
  std::vector<std::string> forbidden;
};

const std::vector<Restriction> restrictions{
    {"values in, values out: no DDS, files, sockets, clocks, threads, logging, command lines",
     {"text", "samples", "geometry", "statistics", "collation", "settings", "attitude", "calibration/model",
      "calibration/fit", "calibration/drive", "estimation", "estimation/documented", "estimation/kalman",
      "estimation/offline", "estimation/strapdown", "doctor/motion", "marvelmind", "sim"},
     {dds_headers, file_headers, socket_headers, clock_headers, thread_headers, logging_headers,
      command_line_headers}},
    {"clocks alone: no DDS, files, sockets, threads, command lines",
     {"clocks"},
     {dds_headers, file_headers, socket_headers, thread_headers, command_line_headers}},
    {"logging alone: no DDS, sockets, clocks of the host, command lines",
     {"logging"},
     {dds_headers, R"(sys/socket\.h|netinet/.*|asio.*)", "ctime|time\\.h|sys/time\\.h",
      command_line_headers}},
    {"states in words: no DDS, files, sockets, clocks, threads, command lines",
     {"transitions"},
     {dds_headers, file_headers, socket_headers, clock_headers, thread_headers, "iostream|ostream|print",
      command_line_headers}},
    {"files alone: no DDS, sockets, threads, command lines",
     {"files", "files/toml", "mcap", "recording", "config", "ros2/arguments"},
     {dds_headers, socket_headers, thread_headers, command_line_headers}},
    {"offline: no DDS, sockets, clocks, threads, command lines",
     {"evaluation", "page", "plots"},
     {dds_headers, socket_headers, clock_headers, thread_headers, command_line_headers}},
    {"recordings: no sockets, clocks, threads, command lines, nor Cyclone DDS of their own",
     {"bus_log"},
     {"dds/.*|ddsc/.*", socket_headers, clock_headers, thread_headers, command_line_headers}},
    {"no DDS, command lines", {"transport", "terminal"}, {dds_headers, command_line_headers}},
    {"no sockets, command lines", {"dds/binding", "dds/qos", "dds/topics"}, {"asio.*", command_line_headers}},
    {"no files, sockets, clocks, threads, command lines",
     {"ros2/messages"},
     {file_headers, socket_headers, clock_headers, thread_headers, command_line_headers}},
    {"no Cyclone DDS of their own, command lines, or libraries that an edge module wraps",
     {"process", "observation", "observation/bus", "launch", "bridge", "recorder", "player", "fusion",
      "monitor", "monitor/echo", "doctor/rules", "doctor/probe", "settings_client", "ros2/relay", "web",
      "web/foxglove", "web/live", "web/recording"},
     {"dds/.*|ddsc/.*", command_line_headers, "asio.*", "toml.*", "pugixml.*", "yaml-cpp/.*", "spdlog/.*",
      "boost/.*"}},
    {"no DDS, files, clocks, command lines", {"web/http"}, {dds_headers, file_headers, command_line_headers}},
};

bool is_forbidden(const Restriction& restriction, const std::string& header) {
  return std::any_of(
      restriction.forbidden.begin(), restriction.forbidden.end(),
      [&header](const std::string& text) { return std::regex_match(header, std::regex(text)); });
}

/// Whether `from` reaches `to` over the link lists.
bool reaches(const std::string& from, const std::string& to, Names& visited) {
  for (const auto& [folder, module] : modules()) {
    if (target_name(folder) != from) continue;
    for (const std::string& used : module.uses) {
      if (used == from) continue;  // its own name, in further commands of its CMakeLists.txt
      if (used == to) return true;
      if (visited.insert(used).second && reaches(used, to, visited)) return true;
    }
  }
  return false;
}

TEST_CASE("a module includes only itself and what its CMakeLists.txt lists") {
  Breaches breaches;
  for (const auto& [folder, module] : modules()) {
    for (const fs::path& file : module.sources()) {
      for (const std::string& header : includes_of(file)) {
        const std::string target = target_of(header);
        if (target.empty() || target == target_name(folder) || module.uses.contains(target)) continue;
        breaches.push_back(place(file, header));
      }
    }
  }
  CHECK(modules().size() > 20);
  CHECK(breaches == none);
}

TEST_CASE("modules depend on each other in one direction only") {
  for (const auto& [folder, module] : modules()) {
    CAPTURE(folder);
    Names visited;
    CHECK_FALSE(reaches(target_name(folder), target_name(folder), visited));
  }
}

TEST_CASE("every source belongs to a module, and every module is restricted") {
  Names restricted;
  for (const Restriction& restriction : restrictions) {
    restricted.insert(restriction.folders.begin(), restriction.folders.end());
  }
  for (const auto& [folder, module] : modules()) {
    CAPTURE(folder);
    CHECK(restricted.contains(folder));
  }
  for (const char* half : {"src", "include/sonopose"}) {
    for (const fs::path& file : sources_in(root / half, true)) {
      if (file == root / "src/precompiled.cpp") continue;
      CAPTURE(file);
      CHECK(modules().contains(fs::relative(file.parent_path(), root / half).string()));
    }
  }
}

TEST_CASE("a module's folder is its namespace") {
  static const std::regex opened(R"(\nnamespace (sonopose[\w:]*) \{)");
  Breaches breaches;
  for (const auto& [folder, module] : modules()) {
    std::string own = folder;
    for (std::size_t at = 0; (at = own.find('/', at)) != std::string::npos;) own.replace(at, 1, "::");
    for (const fs::path& file : module.sources()) {
      // The native types are the vocabulary of all modules: they are in sonopose itself. The DDS binding and
      // ROS 2's messages name their parent: what follows builds on them.
      const Names allowed{folder == "samples"             ? "sonopose"
                          : folder == "calibration/model" ? "sonopose::calibration"
                          : folder == "dds/binding"       ? "sonopose::dds"
                          : folder == "ros2/messages"     ? "sonopose::ros2"
                                                          : "sonopose::" + own};
      if (file.filename() == "idl_types.hpp") continue;  // specialises a template of the binding
      const auto names = matches_of(text_of(file), opened);
      const bool found =
          names.empty() || std::any_of(names.begin(), names.end(), [&](const std::string& name) {
            return std::any_of(allowed.begin(), allowed.end(),
                               [&](const std::string& a) { return name.starts_with(a); });
          });
      if (!found) breaches.push_back(place(file, names.front()));
    }
  }
  CHECK(breaches == none);
}

TEST_CASE("no module reaches beyond its side of the world") {
  for (const Restriction& restriction : restrictions) {
    CAPTURE(restriction.what);
    Breaches breaches;
    for (const std::string& folder : restriction.folders) {
      CAPTURE(folder);
      REQUIRE(modules().contains(folder));
      for (const fs::path& file : modules().at(folder).sources()) {
        for (const std::string& header : includes_of(file)) {
          if (is_forbidden(restriction, header)) breaches.push_back(place(file, header));
        }
      }
    }
    CHECK(breaches == none);
  }
}

TEST_CASE("only the DDS modules call Cyclone DDS") {
  static const std::regex call(R"((\bdds_[a-z_]+\s*\(|\bDDS_[A-Z_]+\b))");
  Breaches breaches;
  for (const char* folder : {"src", "include/sonopose", "apps"}) {
    for (const fs::path& file : sources_in(root / folder, true)) {
      if (file.string().find("/dds/") != std::string::npos) continue;
      for (const std::string& found : matches_of(text_of(file), call)) breaches.push_back(place(file, found));
    }
  }
  CHECK(breaches == none);
}

TEST_CASE("one module reads the host's clock") {
  static const std::regex reading(R"(\b(system_clock|high_resolution_clock|clock_gettime|time\(nullptr\)))");
  const Names readers{"clocks"};
  Breaches breaches;
  for (const auto& [folder, module] : modules()) {
    if (readers.contains(folder)) continue;
    for (const fs::path& file : module.sources()) {
      for (const std::string& found : matches_of(text_of(file), reading))
        breaches.push_back(place(file, found));
    }
  }
  CHECK(breaches == none);
}

TEST_CASE("programs are thin: a command line over one process or one evaluation") {
  const std::size_t most_lines = 150;
  const auto programs = sources_in(root / "apps", false);
  CHECK(programs.size() > 10);
  for (const fs::path& file : programs) {
    CAPTURE(file);
    const std::string text = text_of(file);
    CHECK(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) <= most_lines);
  }
}

}  // namespace dependencies_test
