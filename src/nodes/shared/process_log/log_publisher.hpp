#pragma once
/// \file
/// Publishes the log of the process on the bus, for pages and remote programs.

#include "logging/log.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/log_line.hpp>

namespace sonopose::process_log {

/// One per process. Writes on the thread of the log, which never waits for a reader. Debug lines, and lines
/// that cannot be written, appear on standard error only.
class LogPublisher final : public logging::Listener {
public:
  /// Throws dds::core::Exception.
  LogPublisher(const dds::domain::DomainParticipant& participant, const dds::qos::Provider& qos);

  void on(const logging::Line& line) noexcept override;

private:
  LogLine line_;  ///< kept for its memory
  dds::pub::DataWriter<sonopose_LogLine> writer_;
  logging::Listening listening_{*this};  ///< destroyed first
};

}  // namespace sonopose::process_log
