#pragma once
/// \file
/// The contents of a file except its messages.

#include "mcap/records.hpp"

#include <string>
#include <utility>
#include <vector>

namespace sonopose::mcap {

/// A part of the file with messages.
struct Block {
  enum class Kind {
    chunk,
    plain,  ///< a run of records outside of chunks
    cut,    ///< a chunk that is cut by the end of the file
  };
  Kind kind = Kind::chunk;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  TimeSpan log_times;                   ///< log times of its messages
  std::vector<std::uint16_t> channels;  ///< channels of its messages, ascending
  bool was_scanned = false;             ///< messages of other channels were named as damage
  std::size_t file = 0;                 ///< number of the file, in a recording of several
};

struct Contents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  Statistics statistics;
  std::vector<Block> blocks;                   ///< blocks in file order, without overlap
  std::vector<Extent> metadata;                ///< metadata records in file order, without overlap
  std::vector<Extent> attachments;             ///< attachments in file order, without overlap
  std::vector<std::string> damages;            ///< descriptions of damage in the file
  std::vector<std::string> unreadable_blocks;  ///< damages that cost messages before the end
  std::uint64_t lost_messages = 0;             ///< messages that the file counts, but that were not found
  bool has_uncounted_loss = false;             ///< damage costs messages that nothing counts
  bool is_indexed = false;                     ///< the summary was used; otherwise the whole file was read

  /// Keeps the first ones of a file, which are enough.
  void add_damage(std::string text) { add(damages, std::move(text)); }

  /// Reports damage of a chunk, or of messages outside of chunks.
  void add_unreadable_block(const std::string& text) {
    add(damages, text);
    add(unreadable_blocks, text);
  }

private:
  static void add(std::vector<std::string>& texts, std::string text) {
    constexpr std::size_t max_damages = 100;
    if (texts.size() < max_damages) texts.push_back(std::move(text));
  }
};

}  // namespace sonopose::mcap
