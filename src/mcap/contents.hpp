#pragma once
/// \file
/// What a file has, apart from its messages.

#include "mcap/records.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::mcap {

/// A part of the file with messages.
struct Block {
  enum class Kind {
    chunk,
    plain,  ///< a run of records outside of chunks
    cut,    ///< a chunk that the file ends in
  };
  Kind kind = Kind::chunk;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  TimeSpan log_times;  ///< of its messages
  std::vector<std::uint16_t>
      channels;  ///< those of its messages, in a scanned file in order; empty: not known
};

/// The place of a record.
struct Extent {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  ///< with its opcode and its length
};

struct Contents {
  std::string profile;
  std::string library;
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  Statistics statistics;
  std::vector<Block> blocks;                   ///< in the order of the file; none overlaps another
  std::vector<Extent> metadata;                ///< the same
  std::vector<std::string> damages;            ///< what is wrong with the file, in words
  std::vector<std::string> unreadable_blocks;  ///< those of the damages that cost messages before the end
  bool is_indexed = false;                     ///< the summary was used; otherwise all of the file was read

  /// The first ones of a file are enough.
  void add_damage(std::string text) { add(damages, std::move(text)); }

  /// Of a chunk, or of messages outside of chunks.
  void add_unreadable_block(const std::string& text) {
    add(damages, text);
    add(unreadable_blocks, text);
  }

private:
  static void add(std::vector<std::string>& texts, std::string text) {
    constexpr std::size_t most_damages = 100;
    if (texts.size() < most_damages) texts.push_back(std::move(text));
  }
};

}  // namespace sonopose::mcap
