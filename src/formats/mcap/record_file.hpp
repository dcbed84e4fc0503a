#pragma once
/// \file
/// Reads records by their place in a file.

#include "mcap/byte_source.hpp"
#include "mcap/contents.hpp"
#include "mcap/decoder.hpp"
#include "mcap/expansion.hpp"

#include <memory>
#include <utility>

namespace sonopose::mcap {

// Limits of memory. A file that exceeds them is refused, with the place and the limit.
inline constexpr std::uint64_t max_record_bytes = 256U << 20U;
inline constexpr std::uint64_t max_chunk_bytes = 256U << 20U;  ///< limit of its decompressed records

/// The records of a block, and the places of its messages in them.
struct LoadedBlock {
  struct Item {
    std::uint64_t log_time_ns = 0;
    std::uint32_t offset = 0;  ///< offset of the content
    std::uint32_t size = 0;    ///< size of the content
    std::uint16_t channel_id = 0;
  };
  Bytes records;
  std::vector<Item> messages;  ///< messages in file order

  [[nodiscard]] Message message(const Item& item) const;
  /// Bytes that the block takes in memory.
  [[nodiscard]] std::uint64_t size_bytes() const {
    return records.capacity() + messages.capacity() * sizeof(Item);
  }
};

/// Receives the records of a block other than messages, one at a time: a block can have millions of
/// definitions.
class Definitions {
public:
  Definitions() = default;
  virtual ~Definitions() = default;
  Definitions(const Definitions&) = delete;
  Definitions& operator=(const Definitions&) = delete;

  virtual void on(Schema schema, const Place& place) = 0;
  virtual void on(Channel channel, const Place& place) = 0;
  /// Reports damage that leaves a definition usable.
  virtual void on_damage(std::string text) = 0;
};

/// Reads any record of a file. Checks every length before memory is allocated for it.
class RecordFile {
public:
  explicit RecordFile(std::unique_ptr<ByteSource> source) : source_{std::move(source)} {}

  [[nodiscard]] const std::string& name() const { return source_->name(); }
  [[nodiscard]] std::uint64_t size() const { return source_->size(); }
  [[nodiscard]] Place place(std::uint64_t offset) const { return {name(), offset, {}}; }

  /// Reads `count` bytes from `offset` on. Throws FormatError if the file has fewer, or if they exceed the
  /// limit.
  [[nodiscard]] Bytes bytes(std::uint64_t offset, std::uint64_t count) const;
  /// Reads opcode and length of the record at `offset`, which must end at or before `end`.
  [[nodiscard]] Prefix prefix(std::uint64_t offset, std::uint64_t end) const;
  /// Reads the content of the record at `offset`, which must be of that kind.
  [[nodiscard]] Bytes content(std::uint64_t offset, Opcode opcode) const;
  /// Reads the content of a record of known length; another length is refused.
  [[nodiscard]] Bytes content(const Extent& record, Opcode opcode) const;

  /// Reads, decompresses and checks a block. Throws FormatError. A cut block has the messages before the cut.
  /// Passes the block's definitions to `definitions`, even if a later record is damaged. Throws
  /// files::IoError if the chunks that were loaded expand beyond the limit (expansion.hpp).
  [[nodiscard]] LoadedBlock load(const Block& block, Definitions* definitions = nullptr) const;

private:
  [[nodiscard]] LoadedBlock load_chunk(const Block& block, Definitions* definitions) const;

  std::unique_ptr<ByteSource> source_;
  mutable Expansion expansion_;
};

}  // namespace sonopose::mcap
