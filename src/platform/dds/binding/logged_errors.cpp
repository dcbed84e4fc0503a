#include "dds/binding/logged_errors.hpp"

#include "dds/binding/refusals.hpp"

#include <cstdio>
#include <string_view>
#include <utility>

namespace sonopose::dds {
namespace {

/// Set once, before there is a domain.
MessageSink& message_sink() {
  static auto* const sink = new MessageSink;  // never destroyed: threads of Cyclone DDS use it
  return *sink;
}

MessageLevel level_of(std::uint32_t priority) {
  if (priority == DDS_LC_INFO) return MessageLevel::info;
  if (priority == DDS_LC_FATAL) return MessageLevel::fatal;
  return priority == DDS_LC_WARNING ? MessageLevel::warning : MessageLevel::error;
}

Refusals& refusals() {
  static auto* const all = new Refusals;  // never destroyed, likewise
  return *all;
}

/// Passes a message to the sink of the process, or to standard error as Cyclone DDS does.
void pass_on(void* /*arg*/, const dds_log_data_t* data) {
  const std::string_view message(data->message, data->size);
  const Refusals::Verdict verdict = refusals().on_message(message);
  if (const MessageSink& sink = message_sink()) {
    if (!verdict.text.empty()) sink(MessageLevel::warning, verdict.text);
    if (!verdict.is_about_refusal) sink(level_of(data->priority), message);
    return;
  }
  std::fwrite(data->message - data->hdrsize, 1, data->hdrsize + data->size + 1, stderr);
}

}  // namespace

LoggedErrors::LoggedErrors() {
  dds_set_log_sink(on_message, this);
}

LoggedErrors::~LoggedErrors() {
  dds_set_log_sink(message_sink() ? pass_on : nullptr, nullptr);
}

std::string LoggedErrors::text() {
  const std::lock_guard lock(mutex_);
  return text_;
}

void LoggedErrors::on_message(void* self, const dds_log_data_t* data) {
  if (data->priority != DDS_LC_ERROR ||
      std::string_view(data->message, data->size).starts_with("handshake (")) {
    pass_on(nullptr, data);
    return;
  }
  auto& logged = *static_cast<LoggedErrors*>(self);
  const std::lock_guard lock(logged.mutex_);
  if (!logged.text_.empty()) logged.text_ += "; ";
  logged.text_.append(data->message, data->size);
}

void report_error(const std::string& text) {
  if (const MessageSink& sink = message_sink()) {
    sink(MessageLevel::error, text);
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
}

std::vector<RefusedPeer> refused_peers() {
  return refusals().peers();
}

void send_messages_to(MessageSink sink) {
  message_sink() = std::move(sink);
  dds_set_log_sink(message_sink() ? pass_on : nullptr, nullptr);
}

}  // namespace sonopose::dds
