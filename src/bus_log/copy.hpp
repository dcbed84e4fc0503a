#pragma once
/// \file
/// Messages of recordings into another recording.

#include "bus_log/messages.hpp"
#include "mcap/records.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sonopose::bus_log {

struct CopyRequest {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path output;  ///< must not exist
  Choice choice{};               ///< of each input
  mcap::Compression compression = mcap::Compression::lz4;
  mcap::Selection::Damaged damaged = mcap::Selection::Damaged::refuse;
  std::function<void(double share)> on_progress = {};  ///< now and then: what is done of the inputs
};

struct CopyResult {
  std::uint64_t messages = 0;
  std::uint64_t metadata = 0;
  std::uint64_t attachments = 0;     ///< in the inputs: they are not copied
  std::vector<std::string> damages;  ///< what was left out or is wrong, in words
};

/// One input keeps its order; several are merged by log time, at equal times in the order of the inputs. The
/// metadata of all inputs come first, and channels without messages are kept. While it is written, the output
/// is called OUTPUT.part. Throws files::IoError, also if the inputs have different profiles; the output is
/// then removed.
CopyResult copy(const CopyRequest& request);

}  // namespace sonopose::bus_log
