#pragma once
/// \file
/// Output of the monitor: printed tables, JSON, or a screen.

#include "observation/beacon_observer.hpp"

#include <memory>
#include <string>
#include <vector>

namespace sonopose::monitor {

enum class Output : std::uint8_t {
  table,  ///< one table per second
  json,   ///< one object per second
  screen  ///< full-screen, with keys; requires a terminal (terminal::is_screen)
};

/// The output of the monitor in one of its forms.
class Display {
public:
  Display() = default;
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;
  virtual ~Display() = default;

  /// Shows received views, with their counters as they are. Call it once a second.
  virtual void show(std::vector<observation::BeaconView> views, std::vector<std::string> warnings) = 0;

  /// Handles keys. Call it many times a second. Returns true if the user wants to quit.
  virtual bool poll() { return false; }
};

/// Creates a display: a table instead of a screen if the terminal's type is unknown. Throws
/// std::system_error.
std::unique_ptr<Display> make_display(Output output);

}  // namespace sonopose::monitor
