#include "web/status_hook.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <spawn.h>
#include <string_view>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace sonopose::web {
namespace {

constexpr TimeNs min_interval_ns = 10'000'000'000;
constexpr TimeNs usual_duration_ns = 60'000'000'000;

/// The environment of this process and these variables, which replace others of their names.
std::vector<std::string> environment_with(std::vector<std::string> variables) {
  const std::size_t own = variables.size();
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view other = *variable;
    const bool is_replaced = std::any_of(
        variables.begin(), variables.begin() + static_cast<std::ptrdiff_t>(own),
        [other](const std::string& each) { return other.starts_with(each.substr(0, each.find('=') + 1)); });
    if (!is_replaced) variables.emplace_back(other);
  }
  return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Starts the shell with default signals: this process may block or ignore some. Returns 0 and sets errno if
/// it cannot.
pid_t start_shell(const std::string& command, std::vector<std::string> environment) {
  std::vector<std::string> words{"sh", "-c", command};
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  ::sigemptyset(&none);
  sigset_t all;
  ::sigfillset(&all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);  // the server's sockets
  pid_t process = 0;
  errno = ::posix_spawn(&process, "/bin/sh", &actions, &attributes, pointers_to(words).data(),
                        pointers_to(environment).data());
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  return errno == 0 ? process : 0;
}

}  // namespace

StatusHook::StatusHook(std::string command) : command_(std::move(command)) {}

void StatusHook::update(const observation::bus::BusSnapshot& snapshot, SteadyTime now) {
  if (command_.empty()) return;
  reap(now);
  for (const observation::BeaconView& view : snapshot.beacons) {
    Beacon& beacon = beacons_[view.address];
    beacon.words = observation::stream_words(view);
  }
  for (const observation::BeaconView& view : snapshot.gone) beacons_[view.address].words = "gone";
  if (running_.process != 0) return;
  const auto is_due = [now](const auto& entry) {
    return entry.second.words != entry.second.reported && now >= entry.second.due;
  };
  // After the last one, so that each beacon has its turn.
  auto next = std::find_if(beacons_.upper_bound(last_), beacons_.end(), is_due);
  if (next == beacons_.end()) next = std::find_if(beacons_.begin(), beacons_.end(), is_due);
  if (next != beacons_.end()) run(next->first, next->second, now);
}

/// Ends the wait for a command that has ended.
void StatusHook::reap(SteadyTime now) {
  if (running_.process == 0) return;
  int status = 0;
  if (::waitpid(running_.process, &status, WNOHANG) == 0) {
    if (!running_.is_slow && now - running_.began > usual_duration_ns) {
      running_.is_slow = true;
      logging::warning(
          "the --on-status command has been running for more than a minute; the next one waits for it");
    }
    return;
  }
  running_ = {};
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (code != 0 && code != reported_code_) {
    logging::warning(fmt::format("the command of --on-status ended with code {}", code));
  }
  reported_code_ = code;
}

void StatusHook::run(BeaconAddress address, Beacon& beacon, SteadyTime now) {
  last_ = address;
  beacon.due = now + min_interval_ns;
  const pid_t process = start_shell(
      command_,
      environment_with({fmt::format("SONOPOSE_BEACON={}", address), "SONOPOSE_STATUS=" + beacon.words,
                        "SONOPOSE_STATUS_BEFORE=" + beacon.reported}));
  if (process == 0) {
    logging::warning("the command of --on-status cannot be started: " +
                     std::generic_category().message(errno));
    return;
  }
  beacon.reported = beacon.words;
  running_ = {.process = process, .began = now, .is_slow = false};
}

}  // namespace sonopose::web
