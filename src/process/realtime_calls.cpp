#include "process/realtime.hpp"

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <linux/capability.h>
#include <sched.h>
#include <string>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace sonopose::process {
namespace {

/// Empty where /proc is not there.
std::vector<NamedThread> threads_of_this_process() {
  std::vector<NamedThread> threads;
  std::error_code error;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task", error)) {
    const std::string id = task.path().filename().string();
    NamedThread thread;
    std::from_chars(id.data(), id.data() + id.size(), thread.id);
    std::ifstream comm(task.path() / "comm");
    if (std::getline(comm, thread.name)) threads.push_back(std::move(thread));
  }
  return threads;
}

int set_fifo(int thread_id, int priority) {
  sched_param wanted{};
  wanted.sched_priority = priority;
  // What the process starts later must ask for itself.
  return ::sched_setscheduler(thread_id, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0 ? 0 : errno;
}

int lock_memory(bool future_too) {
  return ::mlockall(future_too ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0 ? 0 : errno;
}

/// Whether the effective capabilities hold CAP_IPC_LOCK.
bool has_ipc_lock() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3]{};
  if (::syscall(SYS_capget, &header, data) != 0) return false;
  return (data[CAP_TO_INDEX(CAP_IPC_LOCK)].effective & CAP_TO_MASK(CAP_IPC_LOCK)) != 0;
}

bool may_lock_everything() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) return true;
  return has_ipc_lock();
}

int hold_awake(const char* device, int& file) {
  const int opened = ::open(device, O_WRONLY | O_CLOEXEC);
  if (opened < 0) return errno;
  const std::int32_t latency_us = 0;
  if (::write(opened, &latency_us, sizeof latency_us) != sizeof latency_us) {
    const int error = errno;
    ::close(opened);
    return error;
  }
  file = opened;
  return 0;
}

}  // namespace

const RealtimeCalls& linux_calls() {
  static const RealtimeCalls calls{threads_of_this_process, set_fifo, lock_memory, may_lock_everything,
                                   hold_awake};
  return calls;
}

}  // namespace sonopose::process
