#include "process/realtime.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <linux/capability.h>
#include <sched.h>
#include <stdexcept>
#include <string>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>

namespace sonopose::process {
namespace {

/// Returns empty without /proc.
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
  // Children do not inherit the priority.
  return ::sched_setscheduler(thread_id, SCHED_FIFO | SCHED_RESET_ON_FORK, &wanted) == 0 ? 0 : errno;
}

int lock_memory(bool future_too) {
  return ::mlockall(future_too ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0 ? 0 : errno;
}

/// Returns true if CAP_IPC_LOCK is among the effective capabilities.
bool has_ipc_lock() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> data{};
  if (::syscall(SYS_capget, &header, data.data()) != 0) return false;
  return (data[CAP_TO_INDEX(CAP_IPC_LOCK)].effective & CAP_TO_MASK(CAP_IPC_LOCK)) != 0;
}

bool may_lock_everything() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) return true;
  return has_ipc_lock();
}

int hold_awake(const char* device, files::Descriptor& file) {
  files::Descriptor opened(::open(device, O_WRONLY | O_CLOEXEC));
  const std::int32_t latency_us = 0;
  if (opened.number() < 0 || ::write(opened.number(), &latency_us, sizeof latency_us) != sizeof latency_us)
    return errno;
  file = std::move(opened);
  return 0;
}

constexpr const char* latency_device = "/dev/cpu_dma_latency";

std::string priority_remedy(int priority) {
  return fmt::format(
      "give the program the capability CAP_SYS_NICE (setcap cap_sys_nice+ep FILE), or its user `rtprio {}` "
      "in "
      "/etc/security/limits.d and log in again; a cgroup without a real-time share (cpu.rt_runtime_us) also "
      "refuses it",
      priority);
}

constexpr const char* memory_remedy =
    "give the program the capability CAP_IPC_LOCK, or its user `memlock unlimited` in /etc/security/limits.d "
    "and log in again";

constexpr const char* awake_remedy =
    R"(a udev rule KERNEL=="cpu_dma_latency", GROUP="realtime", MODE="0660" and the user in that group)";

}  // namespace

const RealtimeCalls& linux_calls() {
  static const RealtimeCalls calls{threads_of_this_process, set_fifo, lock_memory, may_lock_everything,
                                   hold_awake};
  return calls;
}

void Realtime::give_priority(int priority, const RealtimeCalls& calls) {
  const auto give = [&](const std::string& what, int thread_id) {
    const int error = calls.set_fifo(thread_id, priority);
    if (error == 0) {
      applied_.push_back(fmt::format("{}: SCHED_FIFO, priority {}", what, priority));
    } else {
      refused_.push_back(fmt::format("{}: sched_setscheduler(SCHED_FIFO, {}): {}; remedy: {}", what, priority,
                                     std::strerror(error), priority_remedy(priority)));
    }
  };
  constexpr int calling_thread = 0;
  give("main thread", calling_thread);
  const std::vector<NamedThread> threads = calls.threads();
  // These threads share mutexes with the receive thread: avoid priority inversion.
  for (const NamedThread& thread : threads) {
    if (thread.name == predicting_thread_name) give("predicting thread", thread.id);
    if (thread.name == backlog_thread_name) give("backlog thread", thread.id);
  }
  for (const auto* name : {"recv", "tev"}) {
    bool found = false;
    for (const NamedThread& thread : threads) {
      if (thread.name != name) continue;
      found = true;
      give(fmt::format("Cyclone DDS's thread {}", name), thread.id);
    }
    if (!found) {
      refused_.push_back(fmt::format(
          "Cyclone DDS's thread {}: not in /proc/self/task; remedy: apply it after the node was created",
          name));
    }
  }
}

void Realtime::lock_memory(const RealtimeCalls& calls) {
  // With a limit, MCL_FUTURE would make later allocations fail.
  const bool future_too = calls.may_lock_everything();
  const int error = calls.lock_memory(future_too);
  if (error != 0) {
    refused_.push_back(fmt::format("memory: mlockall({}): {}; remedy: {}",
                                   future_too ? "MCL_CURRENT | MCL_FUTURE" : "MCL_CURRENT",
                                   std::strerror(error), memory_remedy));
  } else if (future_too) {
    applied_.emplace_back("memory: locked, current and future");
  } else {
    applied_.emplace_back("memory: locked, current only");
    refused_.push_back(fmt::format(
        "future memory: mlockall(MCL_FUTURE) not tried under a limit (RLIMIT_MEMLOCK); remedy: {}",
        memory_remedy));
  }
}

void Realtime::stay_awake(const RealtimeCalls& calls) {
  const int error = calls.hold_awake(latency_device, awake_file_);
  if (error == 0) {
    applied_.push_back(fmt::format("cores: kept from sleeping, {} held open at 0 us", latency_device));
  } else {
    refused_.push_back(
        fmt::format("cores: open({}): {}; remedy: {}", latency_device, std::strerror(error), awake_remedy));
  }
}

Realtime apply_realtime(int priority, const RealtimeCalls& calls) {
  if (priority < 1 || priority > 99) {
    throw std::invalid_argument(fmt::format("real-time priority {}: allowed are 1 to 99", priority));
  }
  Realtime realtime;
  realtime.lock_memory(calls);
  realtime.stay_awake(calls);
  realtime.give_priority(priority, calls);
  return realtime;
}

void use_batch_scheduling() {
  constexpr int calling_thread = 0;
  if (::sched_getscheduler(calling_thread) != SCHED_OTHER) return;
  const sched_param none{};
  ::sched_setscheduler(calling_thread, SCHED_BATCH, &none);
}

}  // namespace sonopose::process
