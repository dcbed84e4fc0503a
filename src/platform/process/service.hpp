#pragma once
/// \file
/// Messages of the process to the service manager that started it, such as systemd for a unit with
/// Type=notify. Without one, they do nothing. Source: sd_notify(3), sd_watchdog_enabled(3).

#include <sonopose/samples/time.hpp>

#include <string>

namespace sonopose::process {

/// Reports, once, that the program serves.
void report_ready() noexcept;

/// Reports what the program does, in a line.
void report_status(const std::string& status) noexcept;

/// Report that the settings are being reloaded, and then that they are, with a line of status.
void report_reloading() noexcept;
void report_reloaded(const std::string& status) noexcept;

/// Reports that the work continues, at most eight times in the period of the watchdog. Call it from the loop
/// that does or checks the work.
void report_progress(SteadyTime now) noexcept;

/// Reports progress like report_progress. Returns the time of the next call: within a quarter of the period;
/// never without a watchdog.
SteadyTime report_progress_by(SteadyTime now) noexcept;

/// A request to read the settings again: SIGUSR2. SIGHUP ends a program, as the end of its terminal does.
class ReloadRequest {
public:
  /// Catches the signal from now on. Throws std::system_error.
  ReloadRequest();

  /// Returns true once after each request, or after several.
  [[nodiscard]] static bool take() noexcept;
};

}  // namespace sonopose::process
