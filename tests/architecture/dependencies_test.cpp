/// The dependency rules between modules (docs/architecture.md, "Source tree"). A module is a folder below a
/// group of src/, with its public headers under include/sonopose/. It may include only itself and what its
/// CMakeLists.txt lists. The include path makes every header reachable from everywhere, so the compiler alone
/// does not enforce this.

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace dependencies_test {

namespace fs = std::filesystem;
using sonopose::test::read_text;
using Names = std::set<std::string>;
using Breaches = std::vector<std::string>;
const Breaches none;

const fs::path root = SONOPOSE_SOURCE_DIR;

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

/// The names between the brackets or quotes of each #include.
std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex directive(R"(#\s*include\s*[<"]([^>"]+)[>"])");
  return matches_of(read_text(file), directive);
}

std::string target_name(std::string folder) {
  std::replace(folder.begin(), folder.end(), '/', '_');
  return folder;
}

/// Each group may use itself and those before it.
const std::vector<std::string> groups{"core", "platform", "formats", "tools", "nodes"};
const std::string shared = "shared";  // the nodes' common modules

/// One folder that declares a module.
struct Module {
  std::string path;    ///< below src/: "platform/dds/binding"
  std::string folder;  ///< the includes' folder: "dds/binding"
  Names uses;          ///< targets it may use: "samples", "dds_binding", "idl"

  [[nodiscard]] std::string group() const { return path.substr(0, path.find('/')); }

  /// The node that it belongs to, or `shared`; empty in the other groups.
  [[nodiscard]] std::string node() const {
    return group() == groups.back() ? fs::path(path).lexically_relative(groups.back()).begin()->string() : "";
  }

  /// True if the groups allow an include of the other module.
  [[nodiscard]] bool may_use(const Module& other) const {
    const auto own = std::find(groups.begin(), groups.end(), group());
    const auto used = std::find(groups.begin(), groups.end(), other.group());
    return used <= own && (other.node().empty() || other.node() == node() || other.node() == shared);
  }

  [[nodiscard]] std::vector<fs::path> sources() const {
    std::vector<fs::path> found = sources_in(root / "src" / path, false);
    const auto headers = sources_in(root / "include/sonopose" / folder, folder == "dds/psm");
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
    const std::string text = read_text(entry.path());
    const auto names = matches_of(text, declaration);
    if (names.empty()) continue;
    const std::string path = fs::relative(entry.path().parent_path(), root / "src").string();
    static const std::regex group("^(nodes/shared|[a-z]+)/");
    const std::string folder = std::regex_replace(path, group, "");
    CAPTURE(path);
    REQUIRE(names == std::vector{target_name(folder)});  // one folder, one target
    const auto uses = matches_of(text, used);
    modules[folder] = {path, folder, Names(uses.begin(), uses.end())};
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
  if (is_public && path.starts_with("dds/psm/")) return "dds_psm";  // with the folders of the PSM below
  if (is_public) return target_name(folder);
  return modules().contains(folder) ? target_name(folder) : "";
}

std::string place(const fs::path& file, const std::string& what) {
  return fs::relative(file, root).string() + ": " + what;
}

// System headers by what they give access to.
const std::string dds_headers = R"(dds/.*|ddsc/.*|sonopose/idl/.*)";
const std::string file_headers = R"(fstream|filesystem|cstdio|stdio\.h|fcntl\.h|sys/stat\.h)";
const std::string socket_headers = R"(sys/socket\.h|netinet/.*|arpa/.*|asio.*|poll\.h|termios\.h)";
const std::string clock_headers = R"(chrono|ctime|time\.h|sys/time\.h)";
const std::string thread_headers =
    R"(thread|mutex|shared_mutex|condition_variable|atomic|future|stop_token|semaphore)";
const std::string logging_headers = R"(iostream|ostream|fmt/.*|spdlog/.*|print)";
const std::string command_line_headers = R"(CLI/.*|getopt\.h|argp\.h)";

/// Headers forbidden to the modules below `paths`, except those below `exceptions`.
struct Restriction {
  std::string what;
  Names paths;
  Names exceptions;
  std::vector<std::string> forbidden;

  [[nodiscard]] bool concerns(const Module& module) const {
    const auto begins = [&module](const std::string& path) { return module.path.starts_with(path); };
    return std::any_of(paths.begin(), paths.end(), begins) &&
           std::none_of(exceptions.begin(), exceptions.end(), begins);
  }
};

const std::vector<Restriction> restrictions{
    {"values in, values out: no DDS, files, sockets, clocks, threads, logging, command lines",
     {"core", "formats/marvelmind"},
     {},
     {dds_headers, file_headers, socket_headers, clock_headers, thread_headers, logging_headers,
      command_line_headers}},
    {"only platform/dds and what translates samples know DDS",
     {"platform", "formats", "tools"},
     {"platform/dds", "platform/process", "formats/dds", "formats/json", "formats/ros2", "formats/bus_log"},
     {dds_headers}},
    {"only transport, and what talks to the kernel, knows sockets",
     {"platform", "formats", "tools"},
     {"platform/transport", "platform/dds", "platform/terminal", "platform/process", "platform/launch",
      "platform/logging"},
     {socket_headers}},
    {"formats and tools know no clocks and threads",
     {"formats", "tools"},
     {},
     {clock_headers, thread_headers}},
    {"command lines are for programs", {"platform", "formats", "tools", "nodes"}, {}, {command_line_headers}},
    {"nodes use no library that the platform wraps",
     {"nodes"},
     {"nodes/web/http", "nodes/ros2"},
     {"dds/.*|ddsc/.*", "asio.*", R"(toml\+\+/.*)", "pugixml.*", "yaml-cpp/.*", "spdlog/.*", "boost/.*"}},
};

bool is_forbidden(const Restriction& restriction, const std::string& header) {
  return std::any_of(
      restriction.forbidden.begin(), restriction.forbidden.end(),
      [&header](const std::string& text) { return std::regex_match(header, std::regex(text)); });
}

/// True if `from` reaches `to` over the link lists.
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

TEST_CASE("a module includes itself and what its CMakeLists.txt lists, all of it and nothing else") {
  Breaches breaches;
  for (const auto& [folder, module] : modules()) {
    Names unused;
    for (const auto& [other_folder, other] : modules()) {
      const std::string target = target_name(other_folder);
      if (module.uses.contains(target) && target != target_name(folder)) unused.insert(target);
    }
    for (const fs::path& file : module.sources()) {
      for (const std::string& header : includes_of(file)) {
        const std::string target = target_of(header);
        unused.erase(target);
        if (target.empty() || target == target_name(folder) || module.uses.contains(target)) continue;
        breaches.push_back(place(file, header));
      }
    }
    for (const std::string& target : unused) breaches.push_back(module.path + ": no include of " + target);
  }
  CHECK(modules().size() > 20);
  CHECK(breaches == none);
}

TEST_CASE("core uses core, platform adds core, formats add both, tools add formats, a node no other node") {
  Breaches breaches;
  for (const auto& [folder, module] : modules()) {
    for (const auto& [other_folder, other] : modules()) {
      if (module.uses.contains(target_name(other_folder)) && !module.may_use(other))
        breaches.push_back(module.path + ": " + other.path);
    }
  }
  CHECK(breaches == none);
}

TEST_CASE("modules depend on each other in one direction only") {
  for (const auto& [folder, module] : modules()) {
    CAPTURE(folder);
    Names visited;
    CHECK_FALSE(reaches(target_name(folder), target_name(folder), visited));
  }
}

TEST_CASE("every source belongs to a module, every module to a group") {
  Names folders;
  for (const auto& [folder, module] : modules()) {
    CAPTURE(module.path);
    CHECK(std::find(groups.begin(), groups.end(), module.group()) != groups.end());
    folders.insert("src/" + module.path);
    folders.insert("include/sonopose/" + folder);
  }
  for (const char* half : {"src", "include/sonopose"}) {
    for (const fs::path& file : sources_in(root / half, true)) {
      if (file == root / "src/precompiled.cpp") continue;
      if (file.string().starts_with((root / "include/sonopose/dds/psm/dds").string())) continue;
      CAPTURE(file);
      CHECK(folders.contains(fs::relative(file.parent_path(), root).string()));
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
      // The native types are the vocabulary of all modules: they are in sonopose itself. Some folders are
      // parts of one subject, or what the rest of it builds on: they name their parent.
      static const Names parts{"calibration/model", "dds/binding",   "dds/psm",
                               "ros2/inputs",       "ros2/messages", "ros2/node"};
      const bool names_parent = parts.contains(folder) || folder.starts_with("evaluation/");
      const Names allowed{folder == "samples" ? "sonopose"
                          : names_parent      ? "sonopose::" + own.substr(0, own.find(':'))
                                              : "sonopose::" + own};
      if (file.filename() == "idl_types.hpp") continue;  // specialises a template of dds/psm
      const auto names = matches_of(read_text(file), opened);
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
    for (const auto& [folder, module] : modules()) {
      if (!restriction.concerns(module)) continue;
      for (const fs::path& file : module.sources()) {
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
      for (const std::string& found : matches_of(read_text(file), call))
        breaches.push_back(place(file, found));
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
      for (const std::string& found : matches_of(read_text(file), reading))
        breaches.push_back(place(file, found));
    }
  }
  CHECK(breaches == none);
}

TEST_CASE("programs are thin: a command line over one process or one evaluation") {
  const std::size_t max_lines = 150;
  const auto programs = sources_in(root / "apps", false);
  CHECK(programs.size() > 10);
  for (const fs::path& file : programs) {
    CAPTURE(file);
    const std::string text = read_text(file);
    CHECK(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) <= max_lines);
  }
}

}  // namespace dependencies_test
