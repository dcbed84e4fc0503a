#pragma once
// A child process of a benchmark, with its CPU time. The destructor always ends it.

#include <cstdint>
#include <functional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sonopose::benchmarks {

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
  Child& operator=(Child&&) = delete;
  ~Child();

  /// User and system time of all its threads, ns. Throws std::system_error if it has ended.
  [[nodiscard]] std::int64_t cpu_time_ns() const;

  /// Its resident memory, bytes. Throws std::runtime_error if it has ended.
  [[nodiscard]] std::int64_t memory_bytes() const;

private:
  explicit Child(pid_t pid) : pid_(pid) {}
  pid_t pid_;
};

}  // namespace sonopose::benchmarks
