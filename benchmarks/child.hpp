#pragma once
// A process that a benchmark starts, asks for its CPU time, and never leaves behind.

#include <cstdint>
#include <functional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace sonopose::benchmarks {

class Child {
public:
  /// Runs `body` in a copy of this process, which must not have any thread but this one yet.
  static Child fork_to(const std::function<void()>& body);

  /// Runs a program, after `prepare` in its process; what it says on standard error is dropped.
  static Child execute(
      const std::vector<std::string>& command, const std::function<void()>& prepare = [] {});

  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child(Child&& other) noexcept;
  Child& operator=(Child&&) = delete;
  /// Kills and reaps it.
  ~Child();

  /// User and system time of all its threads so far, ns. Throws std::system_error where it has ended.
  [[nodiscard]] std::int64_t cpu_time_ns() const;

private:
  explicit Child(pid_t pid) : pid_(pid) {}
  pid_t pid_;
};

}  // namespace sonopose::benchmarks
