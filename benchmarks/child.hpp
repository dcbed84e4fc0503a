#pragma once
// A child process of a benchmark, and the program that starts it.

#include <CLI/CLI.hpp>

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <sys/types.h>
#include <vector>

namespace sonopose::benchmarks {

/// Parses the command line and calls `body`. Returns the exit code, and prints why it failed.
int run_main(CLI::App& app, int argc, char** argv, const std::function<void()>& body);

void sleep_s(double seconds);

/// User and system time of all threads of a process, ns. Throws std::system_error if it has ended.
std::int64_t cpu_time_ns(pid_t pid);

/// Returns a T of zero bytes, which later children share. Throws std::runtime_error.
template <class T>
T& shared_zeros() {
  void* const memory =
      ::mmap(nullptr, sizeof(T), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("mmap failed");
  return *static_cast<T*>(memory);
}

/// A process that its destruction ends.
class Child {
public:
  /// Runs `body` in a fork of this process, which must not have other threads yet.
  static Child fork_to(const std::function<void()>& body);

  /// Runs a program after calling `prepare` in the child; discards its standard error.
  static Child execute(
      const std::vector<std::string>& command, const std::function<void()>& prepare = [] {});

  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child(Child&& other) noexcept;
  ~Child();

  [[nodiscard]] std::int64_t cpu_time_ns() const { return benchmarks::cpu_time_ns(pid_); }

  [[nodiscard]] pid_t pid() const { return pid_; }

  /// Its resident memory, bytes. Throws std::runtime_error if it has ended.
  [[nodiscard]] std::int64_t memory_bytes() const;

private:
  explicit Child(pid_t pid) : pid_(pid) {}
  pid_t pid_;
};

}  // namespace sonopose::benchmarks
