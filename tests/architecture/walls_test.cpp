/// The walls between the rooms (CONTRIBUTING.md, "Rooms and walls"): the system's include path makes every
/// header reachable from everywhere, so what a file includes is read here.

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path root = SONOPOSE_SOURCE_DIR;

/// A room: its folders under include/sonopose and src, and what it must not touch.
struct Room {
  std::string name;
  Names folders;
  Names other_rooms;        ///< folders of further rooms that it may include
  std::regex never;         ///< headers of the system that it must not include
  std::string never_words;  ///< the same for a reader
};

const char* const dds_headers = R"((dds/.*|ddsc/.*|sonopose/idl/.*))";
const char* const files = R"(fstream|filesystem|cstdio|stdio\.h|fcntl\.h|sys/stat\.h)";
const char* const sockets = R"(sys/socket\.h|netinet/.*|arpa/.*|asio.*|poll\.h|sys/.*|unistd\.h|termios\.h)";
const char* const clocks = R"(chrono|ctime|time\.h|sys/time\.h)";
const char* const threads =
    R"(thread|mutex|shared_mutex|condition_variable|atomic|future|stop_token|semaphore)";
const char* const logging = R"(iostream|ostream|fmt/.*|spdlog/.*|print)";
const char* const command_lines = R"(CLI/.*|getopt\.h|argp\.h)";

std::regex any_of(const std::vector<std::string>& parts) {
  std::string pattern;
  for (const std::string& part : parts) pattern += (pattern.empty() ? "(" : "|(") + part + ")";
  return std::regex(pattern);
}

const std::vector<Room> rooms{
    {"core",
     {"core", "math", "attitude", "calibration", "fusion"},
     {},
     any_of({dds_headers, files, sockets, clocks, threads, logging, command_lines}),
     "DDS, files, sockets, clocks, threads, logging, command lines"},
    {"marvelmind",
     {"marvelmind"},
     {"core", "math"},
     any_of({dds_headers, files, sockets, clocks, threads, logging, command_lines}),
     "DDS, files, sockets, clocks, threads, logging, command lines"},
    {"config",
     {"config"},
     {"core", "math", "attitude", "calibration", "fusion"},
     any_of({dds_headers, sockets, threads, command_lines}),
     "DDS, sockets, threads, command lines"},
    {"sim",
     {"sim"},
     {"core", "math", "marvelmind"},
     any_of({dds_headers, files, sockets, clocks, threads, logging, command_lines}),
     "DDS, files, sockets, clocks, threads, logging, command lines"},
    {"io", {"io"}, {"core", "math"}, any_of({dds_headers, command_lines}), "DDS, command lines"},
    {"replay",
     {"replay"},
     {"core", "math", "attitude", "calibration", "fusion", "config", "sim", "io"},
     any_of({dds_headers, sockets, clocks, threads, command_lines}),
     "DDS, sockets, clocks, threads, command lines"},
    {"dds",
     {"dds"},
     {"core", "math", "idl"},
     any_of({sockets, "asio.*", command_lines}),
     "sockets, command lines"},
    {"ros2",
     {"ros2"},
     {"core", "math", "dds", "idl"},
     any_of({files, sockets, clocks, threads, "asio.*", command_lines}),
     "files, sockets, clocks, threads, command lines"},
    {"nodes",
     {"nodes"},
     {"core", "math", "attitude", "calibration", "fusion", "marvelmind", "config", "sim", "io", "dds", "idl",
      "ros2"},
     any_of({"dds/.*|ddsc/.*", command_lines, "asio.*", "toml.*", "pugixml.*"}),
     "Cyclone DDS itself, command lines, the libraries of other rooms"},
};

bool is_source(const fs::path& path) {
  return path.extension() == ".hpp" || path.extension() == ".cpp";
}

std::vector<fs::path> sources_in(const fs::path& folder) {
  std::vector<fs::path> found;
  if (!fs::exists(folder)) return found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (is_source(entry.path())) found.push_back(entry.path());
  }
  return found;
}

std::vector<fs::path> sources_of(const Room& room) {
  std::vector<fs::path> found;
  for (const std::string& folder : room.folders) {
    for (const fs::path& half : {fs::path("src"), fs::path("include/sonopose")}) {
      const auto more = sources_in(root / half / folder);
      found.insert(found.end(), more.begin(), more.end());
    }
  }
  return found;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// What stands between the brackets or quotes.
std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex directive(R"(\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  std::vector<std::string> names;
  for (const std::string& line : lines_of(file)) {
    std::smatch match;
    if (std::regex_match(line, match, directive)) names.push_back(match[1]);
  }
  return names;
}

/// The folder under include/sonopose that a header of ours stands in; empty for one that is not ours.
std::string room_folder_of(const std::string& header) {
  const std::string ours = "sonopose/";
  if (!header.starts_with(ours)) return {};
  return header.substr(ours.size(), header.find('/', ours.size()) - ours.size());
}

std::string place(const fs::path& file, const std::string& what) {
  return fs::relative(file, root).string() + ": " + what;
}

using Breaches = std::vector<std::string>;

Breaches breaches_of(const Room& room) {
  Breaches breaches;
  for (const fs::path& file : sources_of(room)) {
    for (const std::string& header : includes_of(file)) {
      const std::string folder = room_folder_of(header);
      const bool foreign =
          !folder.empty() && !room.folders.contains(folder) && !room.other_rooms.contains(folder);
      if (foreign || std::regex_match(header, room.never)) breaches.push_back(place(file, header));
    }
  }
  return breaches;
}

}  // namespace

TEST_CASE("no room includes what stands behind its walls") {
  for (const Room& room : rooms) {
    CAPTURE(room.name, room.never_words);
    CHECK(!sources_of(room).empty());
    CHECK(breaches_of(room) == Breaches{});
  }
}

TEST_CASE("Cyclone DDS is called in the DDS layer alone") {
  const std::regex call(R"(\b(dds_[a-z_]+\s*\(|DDS_[A-Z_]+\b))");
  Breaches breaches;
  for (const char* folder : {"src", "include/sonopose", "apps"}) {
    for (const fs::path& file : sources_in(root / folder)) {
      const bool in_dds_room = file.string().find("/dds/") != std::string::npos;
      if (in_dds_room) continue;
      for (const std::string& line : lines_of(file)) {
        if (std::regex_search(line, call)) breaches.push_back(place(file, line));
      }
    }
  }
  CHECK(breaches == Breaches{});
}

TEST_CASE("the host's clock is read at the edges alone") {
  const std::regex reading(
      R"(\b(system_clock|steady_clock|high_resolution_clock|clock_gettime|time\(nullptr\)))");
  Breaches breaches;
  for (const char* folder :
       {"core", "math", "attitude", "calibration", "fusion", "marvelmind", "sim", "config", "dds", "ros2"}) {
    for (const char* half : {"src", "include/sonopose"}) {
      for (const fs::path& file : sources_in(root / half / folder)) {
        for (const std::string& line : lines_of(file)) {
          if (std::regex_search(line, reading)) breaches.push_back(place(file, line));
        }
      }
    }
  }
  CHECK(breaches == Breaches{});
}

TEST_CASE("programs are thin: command lines over what nodes, replay, files and simulator do") {
  Breaches breaches;
  const Names allowed{"nodes", "replay", "sim", "io", "config", "dds", "core", "calibration", "ros2"};
  const auto programs = sources_in(root / "apps");
  CHECK(!programs.empty());
  for (const fs::path& file : programs) {
    for (const std::string& header : includes_of(file)) {
      const std::string folder = room_folder_of(header);
      if (!folder.empty() && !allowed.contains(folder)) breaches.push_back(place(file, header));
    }
    CHECK(lines_of(file).size() <= 140);
  }
  CHECK(breaches == Breaches{});
}

TEST_CASE("everything stands in a room") {
  Names known{"idl"};
  for (const Room& room : rooms) known.insert(room.folders.begin(), room.folders.end());
  for (const char* half : {"src", "include/sonopose"}) {
    for (const auto& entry : fs::directory_iterator(root / half)) {
      CAPTURE(entry.path());
      CHECK((!entry.is_directory() || known.contains(entry.path().filename().string())));
    }
  }
}

TEST_CASE("one target per room is linked with what it may use") {
  // The link lists are the same walls, written a second time where the linker reads them.
  const auto text = [](const char* room) {
    std::string all;
    for (const std::string& line : lines_of(root / "src" / room / "CMakeLists.txt")) all += line + "\n";
    return all;
  };
  for (const char* room : {"core", "marvelmind", "config", "sim", "io"}) {
    CAPTURE(room);
    const std::string list = text(room);
    CHECK(list.find("sonopose_room(") != std::string::npos);
    CHECK(list.find("sonopose::dds") == std::string::npos);
    CHECK(list.find("ddsc") == std::string::npos);
  }
  CHECK(text("dds").find("sonopose::io") == std::string::npos);
}
