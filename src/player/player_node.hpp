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
  double rate = 1;                  ///< of real time; 0: as fast as the readers
  bool loop = false;                ///< until stopped
  double start_s = 0;               ///< from here on, since the first message of the file
  std::optional<double> end_s;      ///< to here; empty: to the end
  std::vector<std::string> topics;  ///< by either name; empty: all
  bool restamp = false;             ///< moves all times, so that the first message was received now
  bool wait_for_readers = true;     ///< before the first message, until a topic has a reader
  std::size_t readers = 0;          ///< before the first message, until each topic has so many
};

struct PlayerReport {
  std::uint64_t played = 0;   ///< messages, with the ends of instances
  std::uint64_t refused = 0;  ///< that are not of their topic's type
  std::uint64_t damaged = 0;  ///< chunks of the file that cannot be read
  double duration_s = 0;
};

/// Plays until the end or the stop. What is not played is logged with the reason. Throws dds::Error,
/// dds::qos::FileError, files::IoError (mcap::FormatError), std::invalid_argument for a topic that the file
/// does not have and for times without messages.
PlayerReport play(const PlayerOptions& options, PlayControl& control, const process::StopSignal& stop);

}  // namespace sonopose::player
