#include "mcap/expansion.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace sonopose::mcap {

namespace {

std::uint64_t given_limit = 0;

}  // namespace

void set_max_expanded(std::uint64_t bytes) {
  given_limit = bytes;
}

std::uint64_t max_expanded(std::uint64_t file_bytes) {
  constexpr std::uint64_t least = 4'000'000'000;
  constexpr std::uint64_t ratio = 200;
  if (const std::uint64_t given = given_limit; given > 0) return given;
  return std::max(least, ratio * std::min(file_bytes, std::numeric_limits<std::uint64_t>::max() / ratio));
}

void Expansion::add(const Place& chunk, std::uint64_t file_bytes, std::size_t bytes, std::size_t messages) {
  if (!counted_.insert(chunk.offset).second) return;
  bytes_ += bytes + bytes_per_message * messages;
  const std::uint64_t limit = max_expanded(file_bytes);
  if (bytes_ <= limit) return;
  throw files::IoError(chunk.text() + ": the chunks expand to more than " + std::to_string(limit) +
                       " bytes, with " + std::to_string(bytes_per_message) +
                       " for each message; --max-expanded changes this limit");
}

}  // namespace sonopose::mcap
