#pragma once
/// \file
/// Errors that Cyclone DDS logs. Internal to this module.

#include <sonopose/dds/binding/domain.hpp>

#include <mutex>
#include <string>

namespace sonopose::dds {

/// Collects the errors that Cyclone DDS logs: its return codes do not have the reason. Passes other messages
/// on.
class LoggedErrors {
public:
  LoggedErrors();
  LoggedErrors(const LoggedErrors&) = delete;
  LoggedErrors& operator=(const LoggedErrors&) = delete;
  ~LoggedErrors();

  /// Returns the errors so far in one line.
  std::string text();

private:
  static void on_message(void* self, const dds_log_data_t* data);

  std::mutex mutex_;  ///< threads of other domains log too
  std::string text_;
};

/// Passes an error to the sink of the process, or to standard error.
void report_error(const std::string& text);

}  // namespace sonopose::dds
