#include "process/stop_signal.hpp"

#include "clocks/clocks.hpp"
#include "process/emergency_cleanup.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace stop_signal_test {

using namespace sonopose;
using namespace sonopose::process;

constexpr TimeNs ms = 1'000'000;
constexpr TimeNs minute = 60'000 * ms;

/// Sets these signals to their default, as at the start of a process, and restores their handlers on
/// destruction.
class KeptHandlers {
public:
  KeptHandlers() {
    for (std::size_t i = 0; i < signals.size(); ++i) {
      ::sigaction(signals[i], nullptr, &before_[i]);
      ::signal(signals[i], SIG_DFL);
    }
  }
  KeptHandlers(const KeptHandlers&) = delete;
  KeptHandlers& operator=(const KeptHandlers&) = delete;
  ~KeptHandlers() {
    for (std::size_t i = 0; i < signals.size(); ++i) ::sigaction(signals[i], &before_[i], nullptr);
  }

  static constexpr std::array signals{SIGINT, SIGTERM, SIGHUP, SIGXCPU};

private:
  std::array<struct sigaction, signals.size()> before_{};
};

SCENARIO("a wait ends at its deadline or at the stop") {
  GIVEN("a stop that was not requested") {
    StopSignal stop;
    CHECK_FALSE(stop.requested());
    THEN("a wait lasts until its deadline") {
      const SteadyTime deadline = clocks::steady_now() + 30 * ms;
      CHECK_FALSE(stop.wait_until(deadline));
      CHECK(clocks::steady_now() >= deadline);
    }
    THEN("a wait is not rounded up to milliseconds: the best of many ends as the best sleep does") {
      TimeNs min_late_ns = minute;
      TimeNs min_late_sleep_ns = minute;
      for (int i = 0; i < 100; ++i) {
        SteadyTime deadline = clocks::steady_now() + 300'000;
        CHECK_FALSE(stop.wait_until(deadline));
        min_late_ns = std::min(min_late_ns, clocks::steady_now() - deadline);
        deadline = clocks::steady_now() + 300'000;
        std::this_thread::sleep_for(std::chrono::microseconds(300));
        min_late_sleep_ns = std::min(min_late_sleep_ns, clocks::steady_now() - deadline);
      }
      CHECK(min_late_ns >= 0);
      CHECK(min_late_ns < min_late_sleep_ns + ms / 2);
    }
    THEN("a deadline in the past returns at once") {
      CHECK_FALSE(stop.wait_until(clocks::steady_now() - minute));
    }
    WHEN("another thread requests it during a wait") {
      const SteadyTime deadline = clocks::steady_now() + minute;
      const std::jthread other([&stop] { stop.request(); });
      THEN("the wait ends, and the stop stays requested") {
        CHECK(stop.wait_until(deadline));
        CHECK(clocks::steady_now() < deadline);
        CHECK(stop.requested());
        CHECK(stop.wait_until(deadline));
        CHECK(stop.wait_until(clocks::steady_now() - minute));
      }
    }
  }
}

/// Forks a process that calls `prepare`, raises SIGTERM twice with `pause` in between, and exits with 0.
pid_t signalled_twice(
    std::chrono::milliseconds pause, EmergencyCleanup call = nullptr, void (*prepare)() = [] {}) {
  const pid_t child = ::fork();
  if (child == 0) {
    prepare();
    set_emergency_cleanup(call);
    StopSignal listening;
    listening.listen_to_signals();
    ::raise(SIGTERM);
    std::this_thread::sleep_for(pause);
    ::raise(SIGTERM);
    ::_exit(0);
  }
  return child;
}

/// Exit code of the process, or minus the signal that ended it.
int code_of(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Exit code of a process that gets two signals of a group. If a busy machine separates them by a second, the
/// second one counts as a person's, so this tries again.
int code_after_group(EmergencyCleanup call = nullptr) {
  int code = -1;
  for (int tries = 0; tries < 5 && code != 0; ++tries) {
    code = code_of(signalled_twice(std::chrono::milliseconds(0), call));
  }
  return code;
}

/// A cleanup during which Ctrl-C and SIGTERM arrive, on this and on another thread.
void restore_under_signals() noexcept {
  static std::atomic<bool> has_begun{false};
  if (has_begun.exchange(true)) return;
  ::alarm(60);  // instead of the limit of a second, which a busy machine may need
  ::raise(SIGINT);
  ::raise(SIGTERM);
  ::kill(::getpid(), SIGINT);
  ::kill(::getpid(), SIGTERM);
  ::usleep(200'000);
  ::_exit(42);
}

SCENARIO("a second signal of a person who waits ends the process at once") {
  constexpr std::chrono::milliseconds late(1100);
  const auto restores = []() noexcept { ::_exit(42); };
  const auto waits_for_ever = []() noexcept { ::sleep(60); };
  GIVEN("processes that get a second signal, at once and late") {
    const pid_t plain = signalled_twice(late);
    const pid_t restoring = signalled_twice(late, restores);
    const pid_t returning = signalled_twice(late, []() noexcept {});
    const pid_t hanging = signalled_twice(late, waits_for_ever);
    const pid_t hanging_with_blocked_alarm = signalled_twice(late, waits_for_ever, [] {
      sigset_t alarm;
      ::sigemptyset(&alarm);
      ::sigaddset(&alarm, SIGALRM);
      ::pthread_sigmask(SIG_BLOCK, &alarm, nullptr);
    });
    const pid_t signalled_again = signalled_twice(late, restore_under_signals);
    const pid_t signalled_again_elsewhere = signalled_twice(late, restore_under_signals, [] {
      std::thread([] {
        while (true) ::pause();
      }).detach();
    });
    THEN("only the late one counts, after a restore that is limited to a second and not cut short") {
      CHECK(code_after_group() == 0);
      CHECK(code_after_group(restores) == 0);
      CHECK(code_of(plain) == 128 + SIGTERM);
      CHECK(code_of(restoring) == 42);
      CHECK(code_of(returning) == 128 + SIGTERM);
      CHECK(code_of(hanging) == -SIGALRM);
      CHECK(code_of(hanging_with_blocked_alarm) == -SIGALRM);
      CHECK(code_of(signalled_again) == 42);
      const int code = code_of(signalled_again_elsewhere);
#ifndef __SANITIZE_THREAD__  // delivers no signal to a thread in such a wait
      CHECK(code == 42);
#else
      static_cast<void>(code);
#endif
    }
  }
}

SCENARIO("Ctrl-C, SIGTERM, a closed terminal and the end of the processor time set the stop that listens") {
  const KeptHandlers kept;
  for (const int signal : KeptHandlers::signals) {
    StopSignal listening;
    const StopSignal other;
    listening.listen_to_signals();
    REQUIRE(::raise(signal) == 0);
    CHECK(listening.wait_until(clocks::steady_now() + minute));
    CHECK_FALSE(other.requested());
  }
  GIVEN("a process that ignores the end of its terminal, as under nohup") {
    ::signal(SIGHUP, SIG_IGN);
    StopSignal listening;
    listening.listen_to_signals();
    THEN("it goes on") {
      REQUIRE(::raise(SIGHUP) == 0);
      CHECK_FALSE(listening.requested());
    }
  }
  GIVEN("a listening stop that was destroyed") {
    { StopSignal().listen_to_signals(); }
    THEN("a signal has no effect") {
      CHECK(::raise(SIGINT) == 0);
    }
  }
}

SCENARIO("a wakeup ends one wait, and is not a stop") {
  GIVEN("a stop and a wakeup") {
    const StopSignal stop;
    Wakeup wakeup;
    const SteadyTime start = clocks::steady_now();
    WHEN("the wakeup comes before the wait, twice") {
      wakeup.wake();
      wakeup.wake();
      THEN("the first wait returns at once, and the second one lasts") {
        CHECK_FALSE(stop.wait_until(start + minute, wakeup));
        CHECK(clocks::steady_now() < start + minute);
        CHECK_FALSE(stop.wait_until(clocks::steady_now() + 20 * ms, wakeup));
        CHECK(clocks::steady_now() >= start + 20 * ms);
      }
    }
    WHEN("it comes during the wait") {
      std::thread other([&] { wakeup.wake(); });
      THEN("the wait ends") {
        CHECK_FALSE(stop.wait_until(start + minute, wakeup));
        CHECK(clocks::steady_now() < start + minute);
      }
      other.join();
    }
  }
}

SCENARIO("an alarm ends a wait at the time that was set last") {
  GIVEN("a stop and an alarm") {
    const StopSignal stop;
    Alarm alarm;
    const SteadyTime start = clocks::steady_now();
    WHEN("it is not set") {
      THEN("the wait lasts until its deadline") {
        CHECK_FALSE(stop.wait_until(start + 20 * ms, alarm));
        CHECK(clocks::steady_now() >= start + 20 * ms);
      }
    }
    WHEN("it is set to a time in the past") {
      alarm.set(start - 20 * ms);
      THEN("the first wait returns at once, and the second one lasts") {
        CHECK_FALSE(stop.wait_until(start + minute, alarm));
        CHECK(clocks::steady_now() < start + minute);
        CHECK_FALSE(stop.wait_until(clocks::steady_now() + 20 * ms, alarm));
        CHECK(clocks::steady_now() >= start + 20 * ms);
      }
    }
    WHEN("it is moved to a later time") {
      alarm.set(start + 20 * ms);
      alarm.set(start + 60 * ms);
      THEN("the wait ends then") {
        CHECK_FALSE(stop.wait_until(start + minute, alarm));
        CHECK(clocks::steady_now() >= start + 60 * ms);
        CHECK(clocks::steady_now() < start + minute);
        CHECK(alarm.at() == start + 60 * ms);
      }
    }
    WHEN("another thread moves it to an earlier time") {
      alarm.set(start + 2 * minute);
      std::thread other([&] { alarm.set(start + 10 * ms); });
      THEN("the wait ends then") {
        CHECK_FALSE(stop.wait_until(start + minute, alarm));
        CHECK(clocks::steady_now() >= start + 10 * ms);
        CHECK(clocks::steady_now() < start + minute);
      }
      other.join();
    }
  }
}

TEMPLATE_TEST_CASE("a stop that was requested ends a wait with a wakeup or an alarm", "", Wakeup, Alarm) {
  StopSignal stop;
  TestType other;
  stop.request();
  const SteadyTime deadline = clocks::steady_now() + minute;
  CHECK(stop.wait_until(deadline, other));
  CHECK(clocks::steady_now() < deadline);
}

}  // namespace stop_signal_test
