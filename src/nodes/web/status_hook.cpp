#include "web/status_hook.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace sonopose::web {
namespace {

constexpr TimeNs min_interval_ns = 10'000'000'000;
constexpr TimeNs usual_duration_ns = 60'000'000'000;

/// The environment of this process and these variables.
std::vector<std::string> environment_with(std::vector<std::string> variables) {
  for (char** variable = environ; *variable != nullptr; ++variable) variables.emplace_back(*variable);
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
  pid_t process = 0;
  errno = ::posix_spawn(&process, "/bin/sh", nullptr, &attributes, pointers_to(words).data(),
                        pointers_to(environment).data());
  ::posix_spawnattr_destroy(&attributes);
  return errno == 0 ? process : 0;
}

}  // namespace

StatusHook::StatusHook(std::string command) : command_(std::move(command)) {}

void StatusHook::update(const observation::bus::BusSnapshot& second, SteadyTime now) {
  if (command_.empty()) return;
  reap(now);
  for (const observation::BeaconView& view : second.beacons) {
    Beacon& beacon = beacons_[view.address];
    beacon.words = observation::stream_words(view);
    beacon.is_gone = false;
  }
  for (const observation::BeaconView& view : second.gone) {
    Beacon& beacon = beacons_[view.address];
    beacon.words = "gone";
    beacon.is_gone = true;
  }
  for (auto& [address, beacon] : beacons_) {
    if (running_.process != 0) return;
    if (beacon.words != beacon.reported && now >= beacon.due) run(address, beacon, now);
  }
  std::erase_if(beacons_, [](const auto& entry) {
    return entry.second.is_gone && entry.second.reported == entry.second.words;
  });
}

/// Ends the wait for a command that has ended.
void StatusHook::reap(SteadyTime now) {
  if (running_.process == 0) return;
  int status = 0;
  if (::waitpid(running_.process, &status, WNOHANG) == 0) {
    if (!running_.is_slow && now - running_.began > usual_duration_ns) {
      running_.is_slow = true;
      logging::warning("the command of --on-status runs for more than a minute; no other is started before");
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
  const pid_t process = start_shell(
      command_,
      environment_with({fmt::format("SONOPOSE_BEACON={}", address), "SONOPOSE_STATUS=" + beacon.words,
                        "SONOPOSE_STATUS_BEFORE=" + std::exchange(beacon.reported, beacon.words)}));
  beacon.due = now + min_interval_ns;
  if (process == 0) {
    logging::warning("the command of --on-status cannot be started: " +
                     std::generic_category().message(errno));
    return;
  }
  running_ = {.process = process, .began = now, .is_slow = false};
}

}  // namespace sonopose::web
