#include "process_log/log_publisher.hpp"

#include "process/host_name.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <unistd.h>

namespace sonopose::process_log {
namespace {

LogLevel level_of(logging::Level level) {
  switch (level) {
    case logging::Level::debug:
      return LogLevel::debug;
    case logging::Level::info:
      return LogLevel::info;
    case logging::Level::warning:
      return LogLevel::warning;
    case logging::Level::error:
      return LogLevel::error;
    case logging::Level::failure:
      break;
  }
  return LogLevel::failure;
}

}  // namespace

LogPublisher::LogPublisher(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos)
    : writer_(dds::topics::make_writer(participant, qos, dds::topics::log)) {
  line_.host = process::host_name();
  line_.process_id = static_cast<std::uint32_t>(::getpid());
  line_.program = logging::program();
}

void LogPublisher::on(const logging::Line& line) noexcept {
  if (line.level == logging::Level::debug) return;
  ++line_.number;  // includes lines that cannot be written: they are missing
  try {
    line_.level = level_of(line.level);
    line_.time_ns = line.time_ns;
    line_.text = line.text;
    dds::ext::try_write(writer_, dds::topics::to_idl(line_));
    dds::ext::flush(writer_);  // the process may batch its samples
  } catch (...) {              // NOLINT(bugprone-empty-catch): no memory for the line
  }
}

}  // namespace sonopose::process_log
