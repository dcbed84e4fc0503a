#pragma once
/// \file
/// Reduces delays caused by other programs: real-time priority, locked memory, and no deep sleep states of
/// the cores. Each needs a privilege; the process reports what Linux refuses and runs without it.

#include "files/descriptor.hpp"

#include <functional>
#include <string>
#include <vector>

namespace sonopose::process {

/// Name of the fusion's thread that writes predicted poses, which --realtime searches for.
inline constexpr const char* predicting_thread_name = "predict";
/// Name of the fusion's thread that fuses a backlog.
inline constexpr const char* backlog_thread_name = "backlog";

struct NamedThread {
  int id = 0;
  std::string name;
};

/// The system calls, replaceable in tests. Each returns 0 or an errno unless noted.
struct RealtimeCalls {
  std::function<std::vector<NamedThread>()> threads;         ///< threads of this process
  std::function<int(int thread_id, int priority)> set_fifo;  ///< sched_setscheduler(SCHED_FIFO)
  std::function<int(bool future_too)> lock_memory;           ///< mlockall
  std::function<bool()> may_lock_everything;                 ///< true if RLIMIT_MEMLOCK does not apply
  std::function<int(const char* device, files::Descriptor& file)>
      hold_awake;  ///< opens the device and writes a latency of 0 µs
};

const RealtimeCalls& linux_calls();

/// The applied settings. After its destruction, the cores may sleep again.
class Realtime {
public:
  /// One line per setting that took effect.
  [[nodiscard]] const std::vector<std::string>& applied() const { return applied_; }
  /// One line per setting that did not: the call, the cause and a remedy.
  [[nodiscard]] const std::vector<std::string>& refused() const { return refused_; }

private:
  friend Realtime apply_realtime(int priority, const RealtimeCalls& calls);
  void give_priority(int priority, const RealtimeCalls& calls);
  void lock_memory(const RealtimeCalls& calls);
  void stay_awake(const RealtimeCalls& calls);

  files::Descriptor awake_file_;
  std::vector<std::string> applied_;
  std::vector<std::string> refused_;
};

/// Applies real-time settings. The threads on the path of the samples get SCHED_FIFO with `priority` (1…99).
/// These are the calling thread, the predicting and backlog threads, and Cyclone DDS's `recv` (data) and
/// `tev` (acknowledgements, heartbeats). Locks all memory and keeps the cores awake. Call it once, after the
/// node has created its threads. Throws std::invalid_argument for another priority; other errors are in the
/// result.
[[nodiscard]] Realtime apply_realtime(int priority, const RealtimeCalls& calls = linux_calls());

/// Yields the processor to other programs under load, for a process that only watches. Keeps real-time
/// scheduling.
void use_batch_scheduling();

}  // namespace sonopose::process
