#pragma once
/// \file
/// A command of the user that runs when the status of a beacon changes.

#include "observation/bus/bus_watch.hpp"
#include "observation/stream_state.hpp"

#include <map>
#include <string>
#include <sys/types.h>

namespace sonopose::web {

/// Runs a command with the shell when the words of a beacon's status (observation::stream_words) change. The
/// command has SONOPOSE_BEACON, SONOPOSE_STATUS and SONOPOSE_STATUS_BEFORE in its environment. It runs for a
/// beacon at most once in 10 s, and never twice at a time: what changes meanwhile is reported afterwards, if
/// it still differs. Beacons begin as ok, and are gone when they have left. Not thread-safe.
class StatusHook {
public:
  /// An empty command does nothing.
  explicit StatusHook(std::string command);
  StatusHook(const StatusHook&) = delete;
  StatusHook& operator=(const StatusHook&) = delete;
  ~StatusHook() = default;

  /// Call it once a second. Logs a command that fails or runs for more than a minute.
  void update(const observation::bus::BusSnapshot& snapshot, SteadyTime now);

private:
  struct Beacon {
    std::string words = "ok";     ///< latest status
    std::string reported = "ok";  ///< last status that the command was given
    SteadyTime due{};             ///< earliest time of the next command
  };
  struct Command {
    pid_t process = 0;  ///< 0: none runs
    SteadyTime began{};
    bool is_slow = false;
  };

  void reap(SteadyTime now);
  void run(BeaconAddress address, Beacon& beacon, SteadyTime now);

  std::string command_;
  std::map<BeaconAddress, Beacon> beacons_;  ///< all that were ever there
  BeaconAddress last_ = 0;                   ///< last beacon that the command was given
  Command running_;
  int reported_code_ = 0;
};

}  // namespace sonopose::web
