#pragma once
/// \file
/// What a process on the bus can ask of Linux so that other programs hold it up less: real-time priority,
/// memory that is never paged out, cores that do not fall asleep. All of it is a privilege; what is refused
/// is said and done without.

#include <functional>
#include <string>
#include <vector>

namespace sonopose::process {

/// The fusion's thread that writes predicted poses, as the kernel and --realtime know it.
inline constexpr const char* predicting_thread_name = "predict";

/// One thread of this process.
struct NamedThread {
  int id = 0;
  std::string name;
};

/// The system calls, so that a test can have others. Each gives 0 or an errno.
struct RealtimeCalls {
  std::function<std::vector<NamedThread>()> threads;             ///< of this process
  std::function<int(int thread_id, int priority)> set_fifo;      ///< sched_setscheduler(SCHED_FIFO)
  std::function<int(bool future_too)> lock_memory;               ///< mlockall
  std::function<bool()> may_lock_everything;                     ///< no limit of RLIMIT_MEMLOCK holds
  std::function<int(const char* device, int& file)> hold_awake;  ///< opens, and writes a latency of 0 µs
};

/// Those of Linux.
const RealtimeCalls& linux_calls();

/// What was applied lasts as long as this object and the process do: without it cores may sleep again.
class Realtime {
public:
  Realtime() = default;
  Realtime(const Realtime&) = delete;
  Realtime& operator=(const Realtime&) = delete;
  Realtime(Realtime&& other) noexcept;
  Realtime& operator=(Realtime&& other) noexcept;
  ~Realtime();

  /// One line for each thing that holds now.
  [[nodiscard]] const std::vector<std::string>& applied() const { return applied_; }
  /// One line for each that does not: the call, why it failed, and what would help.
  [[nodiscard]] const std::vector<std::string>& refused() const { return refused_; }

private:
  friend Realtime apply_realtime(int priority, const RealtimeCalls& calls);
  void give_priority(int priority, const RealtimeCalls& calls);
  void lock_memory(const RealtimeCalls& calls);
  void stay_awake(const RealtimeCalls& calls);

  int awake_file_ = -1;
  std::vector<std::string> applied_;
  std::vector<std::string> refused_;
};

/// Gives the threads through which samples come and go the priority `priority` (1…99) of SCHED_FIFO: the
/// calling one and Cyclone DDS's `recv` (data) and `tev` (acknowledgements, heartbeats); locks all memory;
/// keeps the cores awake. To be called once, when the node is made, since its threads must exist. Throws
/// std::invalid_argument for another priority; all else is in the object.
[[nodiscard]] Realtime apply_realtime(int priority, const RealtimeCalls& calls = linux_calls());

}  // namespace sonopose::process
