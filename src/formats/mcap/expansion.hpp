#pragma once
/// \file
/// The limit of what the chunks of a file expand to, so that a small file cannot keep a program busy for
/// hours.

#include "mcap/format_error.hpp"

#include <cstddef>
#include <cstdint>
#include <unordered_set>

namespace sonopose::mcap {

/// Bytes that each message counts in addition to its own.
inline constexpr std::uint64_t bytes_per_message = 64;

/// Sets the limit for all files of this process, before one is read; 0: the default one of each file.
void set_max_expanded(std::uint64_t bytes);

/// The limit for a file of this size. By default 4 GB, or 200 times the size if that is more.
std::uint64_t max_expanded(std::uint64_t file_bytes);

/// Counts what the chunks of one file expand to, each chunk once.
class Expansion {
public:
  /// Adds the chunk at this place. Throws files::IoError, not FormatError, beyond the limit: the file is not
  /// damaged, and the rest of it is not to be read.
  void add(const Place& chunk, std::uint64_t file_bytes, std::size_t bytes, std::size_t messages);

private:
  std::unordered_set<std::uint64_t> counted_;  ///< offsets of chunks
  std::uint64_t bytes_ = 0;
};

}  // namespace sonopose::mcap
