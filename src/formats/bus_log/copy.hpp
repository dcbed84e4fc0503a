#pragma once
/// \file
/// Copies messages of recordings into another recording.

#include "bus_log/messages.hpp"
#include "mcap/records.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sonopose::bus_log {

struct CopyRequest {
  std::vector<std::filesystem::path> inputs;  ///< MCAP files, and folders of them
  std::filesystem::path output;               ///< must not exist
  Choice choice{};                            ///< choice from each input
  mcap::Compression compression = mcap::Compression::lz4;
  mcap::Selection::Damaged damaged = mcap::Selection::Damaged::refuse;
  std::function<void(double share)> on_progress =
      {};                         ///< occasional callback with the completed share of the inputs
  bool is_one_recording = false;  ///< the inputs are parts of one recording, which have common times
};

struct CopyResult {
  std::uint64_t messages = 0;
  std::uint64_t stated = 0;         ///< number of messages that the inputs say they have
  bool has_uncounted_loss = false;  ///< damage costs messages that the inputs do not count
  std::uint64_t metadata = 0;
  std::uint64_t attachments = 0;
  std::vector<std::string> damages;  ///< descriptions of what was left out or is wrong
};

/// Copies one input in its own order, and merges several by log time. At equal times, earlier inputs come
/// first. All metadata and attachments come first, then the state of latched topics at the start of the
/// choice. Channels without messages are kept. The output is called OUTPUT.part while it is written. Throws
/// files::IoError and removes the output, for example if the inputs have different profiles, or no message of
/// theirs is selected or readable.
CopyResult copy(const CopyRequest& request);

}  // namespace sonopose::bus_log
