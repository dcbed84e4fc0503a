#pragma once
/// \file
/// Messages of the process to the service manager that started it, such as systemd for a unit with
/// Type=notify. Without one, nothing. Source: sd_notify(3), sd_watchdog_enabled(3).

#include <sonopose/samples/time.hpp>

#include <string>

namespace sonopose::process {

/// Tells the service manager, once, that the program serves.
void report_ready() noexcept;

/// Tells it what the program does, in a line.
void report_status(const std::string& status) noexcept;

/// Tells it that the settings are read again, and then that they have been, with a line of status.
void report_reloading() noexcept;
void report_reloaded(const std::string& status) noexcept;

/// Tells it that the work goes on, at most eight times in the period of its watchdog. Call it from the loop
/// that does or checks the work.
void report_progress(SteadyTime now) noexcept;

/// The same. Returns the time of the next call: within a quarter of that period; without a watchdog, never.
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
