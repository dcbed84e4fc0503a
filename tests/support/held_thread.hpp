#pragma once
/// \file
/// Stops one thread of another process, as if it hung, while the others continue.

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <sys/ptrace.h>
#include <sys/wait.h>

namespace sonopose::test {

/// Stops the thread of this name during its lifetime. Throws std::runtime_error if there is no such thread,
/// or if tracing other processes is not allowed.
class HeldThread {
public:
  HeldThread(int pid, const std::string& name) : thread_(thread_of(pid, name)) {
    if (::ptrace(PTRACE_SEIZE, thread_, nullptr, nullptr) != 0) throw std::runtime_error("PTRACE_SEIZE");
    if (::ptrace(PTRACE_INTERRUPT, thread_, nullptr, nullptr) != 0) {
      throw std::runtime_error("PTRACE_INTERRUPT");
    }
    ::waitpid(thread_, nullptr, __WALL);
  }
  HeldThread(const HeldThread&) = delete;
  HeldThread& operator=(const HeldThread&) = delete;
  ~HeldThread() { ::ptrace(PTRACE_DETACH, thread_, nullptr, nullptr); }

private:
  static int thread_of(int pid, const std::string& name) {
    const std::filesystem::path tasks = "/proc/" + std::to_string(pid) + "/task";
    for (const auto& task : std::filesystem::directory_iterator(tasks)) {
      std::ifstream comm(task.path() / "comm");
      std::string found;
      std::getline(comm, found);
      if (found == name) return std::stoi(task.path().filename().string());
    }
    throw std::runtime_error("process " + std::to_string(pid) + " has no thread " + name);
  }

  int thread_;
};

}  // namespace sonopose::test
