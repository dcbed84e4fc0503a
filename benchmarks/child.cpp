#include "child.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

namespace sonopose::benchmarks {

int run_main(CLI::App& app, int argc, char** argv, const std::function<void()>& body) {
  CLI11_PARSE(app, argc, argv);
  try {
    body();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
    return 1;
  }
  return 0;
}

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

std::int64_t cpu_time_ns(pid_t pid) {
  clockid_t clock = 0;
  timespec time{};
  if (const int error = ::clock_getcpuclockid(pid, &clock); error != 0) {
    throw std::system_error(error, std::generic_category(),
                            "clock_getcpuclockid: a process of the chain ended");
  }
  if (::clock_gettime(clock, &time) != 0)
    throw std::system_error(errno, std::generic_category(), "clock_gettime");
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

Child Child::fork_to(const std::function<void()>& body) {
  const pid_t pid = ::fork();
  if (pid < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (pid > 0) return Child(pid);
  try {
    body();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "benchmark child: %s\n", error.what());
  }
  ::_exit(1);
}

Child Child::execute(const std::vector<std::string>& command, const std::function<void()>& prepare) {
  return fork_to([&] {
    prepare();
    std::vector<char*> arguments;
    for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (std::freopen("/dev/null", "w", stderr) == nullptr) return;
    ::execv(arguments.front(), arguments.data());
  });
}

Child::Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}

Child::~Child() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

std::int64_t Child::memory_bytes() const {
  std::ifstream file(fmt::format("/proc/{}/statm", pid_));
  std::int64_t whole_pages = 0;
  std::int64_t resident_pages = 0;
  if (!(file >> whole_pages >> resident_pages)) throw std::runtime_error("a process of the chain ended");
  return resident_pages * ::sysconf(_SC_PAGESIZE);
}

}  // namespace sonopose::benchmarks
