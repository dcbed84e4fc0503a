#pragma once
/// \file
/// Carries out the page's requests on threads of its own: they wait for a fusion or for the doctor.

#include "process/stop_signal.hpp"
#include "web/page_messages.hpp"
#include "web/page_requests.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

namespace sonopose::web {

class RequestWorker {
public:
  /// Called on the worker's threads.
  using Answer = std::function<void(const Reply& reply)>;
  using Publish = std::function<void(std::string text)>;

  /// `publish` takes the doctor's findings. More than a few requests at a time are refused.
  RequestWorker(dds::DomainOptions domain, std::optional<std::filesystem::path> qos_file, Publish publish);
  RequestWorker(const RequestWorker&) = delete;
  RequestWorker& operator=(const RequestWorker&) = delete;
  /// Gives up what is not done.
  ~RequestWorker();

  void change(ChangeRequest request, Answer answer);
  /// Runs the doctor, unless it runs already.
  void examine(const ExamineRequest& request);
  /// Calls `report` with the share of the doctor's time that has passed, if it runs: never after its
  /// findings.
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
  /// The doctor's findings as a text for the pages; empty if it was stopped.
  [[nodiscard]] std::optional<std::string> examined(double seconds) const;

  dds::DomainOptions domain_;
  std::optional<std::filesystem::path> qos_file_;
  Publish publish_;
  process::StopSignal stop_;
  std::mutex mutex_;  ///< guards the next two
  std::condition_variable_any changed_;
  std::deque<Job> jobs_;
  mutable std::mutex examination_mutex_;  ///< guards the next
  std::optional<Examination> examination_;
  std::jthread settings_thread_;
  std::jthread doctor_thread_;
};

}  // namespace sonopose::web
