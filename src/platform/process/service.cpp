#include "process/service.hpp"

#include "files/descriptor.hpp"

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::process {
namespace {

std::string_view environment_variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

std::uint64_t number_in(std::string_view text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// The socket of the service manager, and the period of its watchdog.
class Manager {
public:
  Manager() {
    const std::string_view path = environment_variable("NOTIFY_SOCKET");
    if (path.empty() || path.size() >= sizeof address_.sun_path) return;
    address_.sun_family = AF_UNIX;
    std::memcpy(address_.sun_path, path.data(), path.size());
    if (path.front() == '@') address_.sun_path[0] = '\0';  // an abstract name
    length_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
    socket_ = files::Descriptor(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const std::string_view watched = environment_variable("WATCHDOG_PID");
    if (!watched.empty() && number_in(watched) != static_cast<std::uint64_t>(::getpid())) return;
    constexpr std::uint64_t max_us = 86'400'000'000;  // a day
    const std::uint64_t period_us = number_in(environment_variable("WATCHDOG_USEC"));
    if (period_us > 0 && period_us <= max_us) watchdog_ns_ = static_cast<TimeNs>(period_us) * 1000;
  }

  /// Sends without waiting: the service manager restarts what it does not hear from.
  void send(std::string_view text) const noexcept {
    if (socket_.number() < 0) return;
    ::sendto(socket_.number(), text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
             reinterpret_cast<const sockaddr*>(&address_), length_);
  }

  [[nodiscard]] TimeNs watchdog_ns() const noexcept { return watchdog_ns_; }

private:
  sockaddr_un address_{};
  socklen_t length_ = 0;
  files::Descriptor socket_;
  TimeNs watchdog_ns_ = 0;
};

const Manager& manager() {
  static const Manager instance;
  return instance;
}

std::atomic<bool> is_ready{false};
std::atomic<TimeNs> progress_reported_ns{0};

// Set by the signal handler, which may use only lock-free atomics.
std::atomic<bool> is_reload_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void sonopose_on_reload_signal(int /*signal*/) {
  is_reload_requested.store(true);
}

}  // namespace

void report_ready() noexcept {
  if (!is_ready.exchange(true)) manager().send("READY=1");
}

void report_status(const std::string& status) noexcept {
  manager().send("STATUS=" + status);
}

void report_reloading() noexcept {
  manager().send("RELOADING=1");
}

void report_reloaded(const std::string& status) noexcept {
  manager().send("READY=1\nSTATUS=" + status);
}

void report_progress(SteadyTime now) noexcept {
  const TimeNs period_ns = manager().watchdog_ns();
  if (period_ns == 0 || now.ns - progress_reported_ns.load() < period_ns / 8) return;
  progress_reported_ns.store(now.ns);
  manager().send("WATCHDOG=1");
}

SteadyTime report_progress_by(SteadyTime now) noexcept {
  report_progress(now);
  const TimeNs period_ns = manager().watchdog_ns();
  return period_ns == 0 ? SteadyTime::max() : now + period_ns / 4;
}

ReloadRequest::ReloadRequest() {
  struct sigaction action {};
  action.sa_handler = sonopose_on_reload_signal;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  if (::sigaction(SIGUSR2, &action, nullptr) != 0) {
    throw std::system_error(errno, std::generic_category(), "sigaction");
  }
}

bool ReloadRequest::take() noexcept {
  return is_reload_requested.exchange(false);
}

}  // namespace sonopose::process
