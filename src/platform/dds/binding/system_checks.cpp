#include "dds/binding/system_checks.hpp"

#include "dds/binding/error.hpp"
#include <sonopose/dds/binding/network_interfaces.hpp>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <latch>
#include <string>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sonopose::dds {
namespace {

/// Descriptors that must be free. The relay and a recording bridge open 14, other programs 8; the rest is for
/// later files.
constexpr std::size_t min_free_descriptors = 24;

/// Threads that must be able to start: five of Cyclone DDS, the rest for those that a program starts later.
constexpr std::size_t min_free_threads = 12;

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

/// Starts up to this many threads at a time and ends them. Returns how many there were.
std::size_t start_threads(std::size_t count) {
  std::latch end(1);
  std::vector<std::jthread> threads;
  threads.reserve(count);
  try {
    while (threads.size() < count) threads.emplace_back([&end] { end.wait(); });
  } catch (const std::system_error&) {  // NOLINT(bugprone-empty-catch): the number of threads shows it
  }
  end.count_down();
  return threads.size();
}

/// Returns true if a process serves this socket of the daemon. Iceoryx waits for the same.
bool is_roudi_running() {
  const int file = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (file < 0) return false;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, "/tmp/roudi", sizeof address.sun_path - 1);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as connect(2) wants it
  const bool connected = ::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(file);
  return connected;
}

}  // namespace

void check_free_descriptors(const std::string& about) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  const std::size_t min_limit = open_below(limit.rlim_cur) + min_free_descriptors;
  if (limit.rlim_cur >= min_limit) return;
  throw Error(about + ": at most " + std::to_string(limit.rlim_cur) +
                  " file descriptors are allowed (ulimit -n), at least " + std::to_string(min_limit) +
                  " are needed",
              DDS_RETCODE_OUT_OF_RESOURCES);
}

void check_free_threads(const std::string& about) {
  const std::size_t started = start_threads(min_free_threads);
  if (started == min_free_threads) return;
  throw Error(
      about, DDS_RETCODE_OUT_OF_RESOURCES,
      "only " + std::to_string(started) + " of " + std::to_string(min_free_threads) +
          " threads can start; a limit of processes (ulimit -u; TasksMax= of a service; --pids-limit of "
          "a container) or of memory (ulimit -v) is too low");
}

void check_shared_memory(const std::string& about, const UserNetwork& user) {
  if (!user.shared_memory || is_roudi_running()) return;
  throw Error(about, DDS_RETCODE_PRECONDITION_NOT_MET,
              "CYCLONEDDS_URI enables shared memory, but its daemon does not run: start iox-roudi, or set "
              "SharedMemory/Enable to false");
}

std::string interface_advice(Network network, const UserNetwork& user) {
  const std::vector<NetworkInterface> usable = network_interfaces();
  std::string text = usable.empty() ? "no interface is up with an IPv4 address"
                                    : "up with an IPv4 address: " + list_of(usable);
  const bool needs_loopback = usable.empty() || (network != Network::lan && user.interfaces.empty());
  const bool has_loopback =
      std::any_of(usable.begin(), usable.end(), [](const NetworkInterface& each) { return each.loopback; });
  if (needs_loopback && !has_loopback) text += "; bring up the loopback with `ip link set lo up`";
  return text;
}

}  // namespace sonopose::dds
