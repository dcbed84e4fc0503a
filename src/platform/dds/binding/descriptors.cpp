#include "dds/binding/descriptors.hpp"

#include <sonopose/dds/binding/error.hpp>

#include <charconv>
#include <filesystem>
#include <string>
#include <sys/resource.h>

namespace sonopose::dds {
namespace {

/// Descriptors that must be free. The relay and a recording bridge open 14, other programs 8; the rest is for
/// later files.
constexpr std::size_t min_free = 24;

/// Counts open descriptors below the limit: a process may have inherited others.
std::size_t open_below(rlim_t limit) {
  std::size_t count = 0;
  std::error_code no_proc;  // none are counted without /proc
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", no_proc)) {
    const std::string name = entry.path().filename();
    rlim_t number = 0;
    std::from_chars(name.data(), name.data() + name.size(), number);
    if (number < limit) ++count;
  }
  return count;
}

}  // namespace

void check_free_descriptors(const std::string& about) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  const std::size_t min_limit = open_below(limit.rlim_cur) + min_free;
  if (limit.rlim_cur >= min_limit) return;
  throw Error(about + ": at most " + std::to_string(limit.rlim_cur) +
                  " file descriptors are allowed (ulimit -n), at least " + std::to_string(min_limit) +
                  " are needed",
              DDS_RETCODE_OUT_OF_RESOURCES);
}

}  // namespace sonopose::dds
