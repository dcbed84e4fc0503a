#include "process/realtime.hpp"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>
#include <unistd.h>
#include <utility>

namespace sonopose::process {
namespace {

constexpr const char* latency_device = "/dev/cpu_dma_latency";

std::string priority_remedy(int priority) {
  return fmt::format(
      "give the program the capability CAP_SYS_NICE (setcap cap_sys_nice+ep FILE), or its user `rtprio {}` "
      "in "
      "/etc/security/limits.d and a new login; a cgroup without real-time share (cpu.rt_runtime_us) refuses "
      "it "
      "too",
      priority);
}

constexpr const char* memory_remedy =
    "give the program the capability CAP_IPC_LOCK, or its user `memlock unlimited` in /etc/security/limits.d "
    "and a new login";

constexpr const char* awake_remedy =
    "a udev rule KERNEL==\"cpu_dma_latency\", GROUP=\"realtime\", MODE=\"0660\" and the user in that group";

}  // namespace

Realtime::Realtime(Realtime&& other) noexcept
    : awake_file_(std::exchange(other.awake_file_, -1)),
      applied_(std::move(other.applied_)),
      refused_(std::move(other.refused_)) {}

Realtime& Realtime::operator=(Realtime&& other) noexcept {
  std::swap(awake_file_, other.awake_file_);
  std::swap(applied_, other.applied_);
  std::swap(refused_, other.refused_);
  return *this;
}

Realtime::~Realtime() {
  if (awake_file_ >= 0) ::close(awake_file_);
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
  // Ours takes a mutex that the receiving thread takes too: whoever could hold it up must not be preempted.
  for (const NamedThread& thread : threads) {
    if (thread.name == predicting_thread_name) give("predicting thread", thread.id);
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
          "Cyclone DDS's thread {}: /proc/self/task names none; remedy: apply it after the node was made",
          name));
    }
  }
}

void Realtime::lock_memory(const RealtimeCalls& calls) {
  // Under a limit, memory of later on would be refused where today's is locked: the process would fail then.
  const bool future_too = calls.may_lock_everything();
  const int error = calls.lock_memory(future_too);
  if (error != 0) {
    refused_.push_back(fmt::format("memory: mlockall({}): {}; remedy: {}",
                                   future_too ? "MCL_CURRENT | MCL_FUTURE" : "MCL_CURRENT",
                                   std::strerror(error), memory_remedy));
  } else if (future_too) {
    applied_.emplace_back("memory: locked, that of later on too");
  } else {
    applied_.emplace_back("memory: what there is now is locked");
    refused_.push_back(fmt::format(
        "memory of later on: mlockall(MCL_FUTURE) not tried under a limit (RLIMIT_MEMLOCK); remedy: {}",
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

}  // namespace sonopose::process
