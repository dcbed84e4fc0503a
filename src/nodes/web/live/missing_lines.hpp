#pragma once
/// \file
/// Detects gaps in the numbers of log lines.

#include <sonopose/samples/log_line.hpp>

#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace sonopose::web::live {

/// Number of the latest line of each process.
class MissingLines {
public:
  /// Number of lines of its process missing before this one, in order of arrival. For an unknown process: all
  /// lines before it. A number that does not rise starts another process.
  std::uint64_t before(const LogLine& line) {
    std::uint64_t& last = last_[{line.host, line.process_id}];
    if (line.number <= last) last = 0;
    const std::uint64_t missing = line.number > 0 ? line.number - last - 1 : 0;
    last = line.number;
    return missing;
  }

  void forget(const std::string& host, std::uint32_t process_id) { last_.erase({host, process_id}); }

private:
  std::map<std::pair<std::string, std::uint32_t>, std::uint64_t> last_;
};

}  // namespace sonopose::web::live
