#pragma once
/// \file
/// The player process: publishes a recording as it was received.

#include "bus_log/moment.hpp"
#include "player/keys.hpp"
#include "process/stop_signal.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::player {

struct PlayerOptions {
  dds::DomainOptions domain;
  std::optional<std::filesystem::path> qos_file;
  std::vector<std::filesystem::path> recording;  ///< MCAP files, or folders of them
  double rate = 1;                               ///< multiple of real time; 0: as fast as the readers
  bool loop = false;                             ///< repeats until stopped
  std::optional<bus_log::Moment> start;          ///< the state of latched topics at this time comes first
  std::optional<bus_log::Moment> end;
  std::optional<double> max_gap_s;     ///< longer times without a message are shortened to this one
  std::vector<std::string> topics;     ///< short or full names; empty: all
  bool restamp = false;                ///< moves all times, so that the first message was received now
  bool wait_for_readers = true;        ///< waits before the first message until a topic has a reader
  std::size_t readers = 0;             ///< readers of each topic to wait for before the first message
  std::function<void()> on_read = {};  ///< called when the recording is read, before it is played
};

struct PlayerReport {
  std::uint64_t played = 0;           ///< messages, including ends of instances
  std::uint64_t refused = 0;          ///< messages that do not fit their topic's type
  std::uint64_t damaged = 0;          ///< unreadable chunks of the recording
  std::uint64_t lost_by_fusions = 0;  ///< events that fusions without --lossless lost at rate 0
  std::uint64_t shortened_gaps = 0;
  double left_out_s = 0;  ///< recorded time that the shortened gaps lack
  double duration_s = 0;
};

/// Plays until the end or the stop. Logs skipped parts with the reason. Throws dds::core::Exception,
/// dds::qos::FileError, files::IoError (mcap::FormatError), std::invalid_argument for a topic that the file
/// lacks, for times without messages, and for a rate or gap that is none.
PlayerReport play(const PlayerOptions& options, PlayControl& control, const process::StopSignal& stop);

}  // namespace sonopose::player
