#pragma once
/// \file
/// The player process: publishes a recording as it was received.

#include "player/keys.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::player {

struct PlayerOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::filesystem::path file;
  double rate = 1;                  ///< multiple of real time; 0: as fast as the readers
  bool loop = false;                ///< repeats until stopped
  double start_s = 0;               ///< start, counted from the first message of the file
  std::optional<double> end_s;      ///< end, likewise; empty: end of the file
  std::vector<std::string> topics;  ///< short or full names; empty: all
  bool restamp = false;             ///< moves all times, so that the first message was received now
  bool wait_for_readers = true;     ///< waits before the first message until a topic has a reader
  std::size_t readers = 0;          ///< readers of each topic to wait for before the first message
};

struct PlayerReport {
  std::uint64_t played = 0;           ///< messages, including ends of instances
  std::uint64_t refused = 0;          ///< messages that do not fit their topic's type
  std::uint64_t damaged = 0;          ///< unreadable chunks of the file
  std::uint64_t lost_by_fusions = 0;  ///< events that fusions without --lossless lost at rate 0
  double duration_s = 0;
};

/// Plays until the end or the stop. Logs skipped parts with the reason. Throws dds::Error,
/// dds::qos::FileError, files::IoError (mcap::FormatError), std::invalid_argument for a topic that the file
/// lacks and for times without messages.
PlayerReport play(const PlayerOptions& options, PlayControl& control, const process::StopSignal& stop);

}  // namespace sonopose::player
