#pragma once
/// \file
/// Carries out the page's requests on threads of its own: they wait for a fusion or for the doctor.

#include "process/stop_signal.hpp"
#include "web/page_messages.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <atomic>
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
  /// The share of the doctor's time that has passed while it runs.
  [[nodiscard]] std::optional<double> examined_share() const;

private:
  static constexpr std::size_t max_waiting = 16;

  struct Job {
    ChangeRequest request;
    Answer answer;
  };

  void run();
  Reply carry_out(const ChangeRequest& request);
  void examine_for(double seconds);

  dds::DomainOptions domain_;
  std::optional<std::filesystem::path> qos_file_;
  Publish publish_;
  process::StopSignal stop_;
  std::mutex mutex_;  ///< guards the next two
  std::condition_variable_any changed_;
  std::deque<Job> jobs_;
  std::atomic<bool> is_examining_ = false;
  std::atomic<SteadyTime> examination_began_ = SteadyTime{};
  std::atomic<double> examination_s_ = 0;
  std::jthread settings_thread_;
  std::jthread doctor_thread_;
};

}  // namespace sonopose::web
