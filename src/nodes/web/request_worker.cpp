#include "web/request_worker.hpp"

#include "clocks/clocks.hpp"
#include "settings_client/settings_client.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <exception>
#include <utility>

namespace sonopose::web {
namespace {

constexpr double answer_timeout_s = 3;

std::string doctor_failure_json(const char* reason) {
  const nlohmann::json finding{
      {"severity", "error"}, {"subject", "doctor"}, {"what", reason}, {"remedy", ""}};
  return nlohmann::json{{"ok", false}, {"findings", {finding}}}.dump(
      -1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

RequestWorker::RequestWorker(dds::domain::DomainParticipant participant,
                             std::optional<std::filesystem::path> qos_file, Examine examine, Publish publish)
    : participant_(std::move(participant)),
      qos_file_(std::move(qos_file)),
      examine_(std::move(examine)),
      publish_(std::move(publish)) {
  settings_thread_ = std::jthread([this] { run(); });
}

RequestWorker::~RequestWorker() {
  {
    const threads::Lock lock(mutex_);  // otherwise the notification may precede the wait
    stop_.request();
  }
  changed_.notify_all();
}

void RequestWorker::change(ChangeRequest request, Answer answer) {
  {
    const threads::Lock lock(mutex_);
    if (jobs_.size() < max_waiting) {
      jobs_.push_back({std::move(request), std::move(answer)});
      changed_.notify_one();
      return;
    }
  }
  answer({.id = request.id, .reason = "too many requests wait for an answer"});
}

void RequestWorker::run() {
  while (true) {
    Job job;
    {
      threads::Lock lock(mutex_);
      changed_.wait(lock, [this] {
        mutex_.assert_held();
        return !jobs_.empty() || stop_.requested();
      });
      if (stop_.requested()) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    Reply reply{.id = job.request.id, .reason = {}};
    try {
      reply = carry_out(job.request);
    } catch (const std::exception& error) {
      reply.reason = error.what();
    }
    job.answer(reply);
  }
}

Reply RequestWorker::carry_out(const ChangeRequest& request) {
  settings_client::SettingsClient client(participant_, qos_file_);
  const std::string no_answer = fmt::format(
      "no fusion answered within {} s; is sonopose-fusion running in this domain?", answer_timeout_s);
  const auto stopped = [this] { return stop_.requested(); };
  Reply reply{.id = request.id, .reason = {}};
  if (request.is_reset) {
    const auto addresses = client.reset(request.settings.address, answer_timeout_s, stopped);
    reply.accepted = !addresses.empty();
    reply.reason = reply.accepted ? "" : no_answer;
    return reply;
  }
  const auto answer = client.change(request.settings, answer_timeout_s, stopped);
  if (!answer) {
    reply.reason = no_answer;
    return reply;
  }
  reply.accepted = answer->accepted;
  reply.reason = answer->reason;
  reply.details = answer->details;
  reply.from_sequence = answer->from_sequence;
  return reply;
}

void RequestWorker::examine(const ExamineRequest& request) {
  {
    const threads::Lock lock(examination_mutex_);
    if (examination_) return;
    examination_ = Examination{.began = clocks::steady_now(), .duration_s = request.seconds};
  }
  doctor_thread_ = std::jthread([this, seconds = request.seconds] {
    const std::optional<std::string> findings = examined(seconds);
    const threads::Lock lock(examination_mutex_);
    examination_.reset();
    if (findings) publish_(*findings);
  });
}

std::optional<std::string> RequestWorker::examined(double seconds) const {
  try {
    const std::string findings = examine_(seconds, stop_);
    if (stop_.requested()) return {};
    return findings_text(findings);
  } catch (const std::exception& error) {
    return findings_text(doctor_failure_json(error.what()));
  }
}

void RequestWorker::report_progress(const std::function<void(double share)>& report) const {
  const threads::Lock lock(examination_mutex_);
  if (!examination_) return;
  report(
      std::min(1.0, seconds_between(examination_->began, clocks::steady_now()) / examination_->duration_s));
}

}  // namespace sonopose::web
