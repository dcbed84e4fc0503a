#pragma once
/// \file
/// Carries out the page's requests on its own threads: they wait for a fusion or for the doctor.

#include "process/stop_signal.hpp"
#include "threads/mutex.hpp"
#include "web/page_messages.hpp"
#include "web/page_requests.hpp"
#include <sonopose/dds/psm/ext.hpp>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <thread>

namespace sonopose::web {

/// Observes the bus for this many seconds or until the stop. Returns the findings as JSON:
/// {"ok": …, "findings": [{"severity", "subject", "what", "remedy"}]}.
using Examine = std::function<std::string(double duration_s, const process::StopSignal& stop)>;

class RequestWorker {
public:
  /// Called on the worker's threads.
  using Answer = std::function<void(const Reply& reply)>;
  using Publish = std::function<void(std::string text)>;

  /// `examine` is the doctor; `publish` takes its findings. Refuses more than a few requests at a time.
  RequestWorker(dds::domain::DomainParticipant participant, std::optional<std::filesystem::path> qos_file,
                Examine examine, Publish publish);
  RequestWorker(const RequestWorker&) = delete;
  RequestWorker& operator=(const RequestWorker&) = delete;
  /// Gives up unfinished requests.
  ~RequestWorker();

  void change(ChangeRequest request, Answer answer);
  /// Runs the doctor, unless it runs already.
  void examine(const ExamineRequest& request);
  /// Calls `report` with the elapsed share of the doctor's time, if it runs; never after its findings.
  void report_progress(const std::function<void(double share)>& report) const;

private:
  static constexpr std::size_t max_waiting = 16;

  struct Job {
    ChangeRequest request;
    Answer answer;
  };

  struct Examination {
    SteadyTime began;
    double duration_s;
  };

  void run();
  Reply carry_out(const ChangeRequest& request);
  /// The doctor's findings as a text for the pages; empty if stopped.
  [[nodiscard]] std::optional<std::string> examined(double seconds) const;

  dds::domain::DomainParticipant participant_;
  std::optional<std::filesystem::path> qos_file_;
  Examine examine_;
  Publish publish_;
  process::StopSignal stop_;
  threads::Mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> jobs_ SONOPOSE_GUARDED_BY(mutex_);
  mutable threads::Mutex examination_mutex_;
  std::optional<Examination> examination_ SONOPOSE_GUARDED_BY(examination_mutex_);
  std::jthread settings_thread_;
  std::jthread doctor_thread_;
};

}  // namespace sonopose::web
