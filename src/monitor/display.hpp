#pragma once
/// \file
/// Where the monitor shows its observations: printed tables, JSON, or a screen.

#include "observation/beacon_observer.hpp"

#include <memory>
#include <string>
#include <vector>

namespace sonopose::monitor {

enum class Output : std::uint8_t {
  table,  ///< one table per second
  json,   ///< one object per second
  screen  ///< full-screen, with keys; the terminal must be one (terminal::is_screen)
};

class Display {
public:
  Display() = default;
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;
  virtual ~Display() = default;

  /// Once a second. Counters as they were received.
  virtual void show(std::vector<observation::BeaconView> views, std::vector<std::string> warnings) = 0;

  /// Many times a second. Returns whether the user wants to quit.
  virtual bool poll() { return false; }
};

/// A table instead of a screen if the type of the terminal is unknown. Throws std::system_error.
std::unique_ptr<Display> make_display(Output output);

}  // namespace sonopose::monitor
