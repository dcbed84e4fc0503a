#pragma once
/// \file
/// Writes an MCAP file: chunks with an index, statistics, checksums.

#include "mcap/byte_sink.hpp"
#include "mcap/chunk.hpp"
#include "mcap/compression.hpp"
#include "mcap/records.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace sonopose::mcap {

struct WriterOptions {
  std::string profile = {};  ///< a well-known profile such as `ros2`; empty: none
  std::string library = "sonopose";
  Compression compression = Compression::lz4;
  std::size_t chunk_size_bytes = 1U << 20U;  ///< size at which a chunk of write(Message) ends
};

/// Writes a file that can be read at any time without what follows. Schemas and channels are written
/// immediately, and each chunk with its index in one append. After an error of the sink the writer continues:
/// an item that could not be written is missing as a whole and not in the statistics, and its messages are
/// counted.
class Writer {
public:
  /// Writes the header. The sink must outlive the writer.
  explicit Writer(ByteSink& sink, WriterOptions options = {});
  /// Closes the file. Call close() first to detect errors.
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  // All of these throw files::IoError if the sink fails, and std::logic_error after close().

  /// Returns the id of the schema, and writes it unless the file already has it.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);
  /// Returns the id of the channel, and writes it unless the file already has it. Throws
  /// std::invalid_argument if the schema is unknown; `schema_id` 0 means none.
  std::uint16_t add_channel(std::uint16_t schema_id, std::string_view topic,
                            std::string_view message_encoding, const TextMap& metadata = {});

  /// Adds a copy of the message to the current chunk. `head` precedes its data. Throws std::invalid_argument
  /// if the channel is unknown.
  void write(const Message& message, std::span<const std::byte> head = {});
  /// Ends the current chunk and writes one that was filled elsewhere. Throws std::invalid_argument if one of
  /// its channels is unknown.
  void write(const Chunk& chunk);
  /// Writes the current chunk, if it has messages.
  void end_chunk();

  void write_metadata(const Metadata& metadata);
  /// Writes the content of an Attachment record as another file has it. Throws FormatError if it is none.
  void write_attachment(std::span<const std::byte> content);
  /// Writes metadata about the end of a recording. May use the space that all other writes leave free, so
  /// that it fits on a full disk.
  void write_last_metadata(const Metadata& metadata);

  /// Writes the current chunk, the index and the statistics. If they do not fit, the file ends without them
  /// and is still complete. Throws the first error after writing everything possible. A second call does
  /// nothing.
  void close();

  [[nodiscard]] std::uint64_t bytes_written() const { return bytes_written_; }
  /// The bytes that close() would add now, apart from the current chunk.
  [[nodiscard]] std::uint64_t closing_bytes() const;
  /// Upper limit of the bytes that a chunk adds to the file, with its index and what close() adds for it.
  [[nodiscard]] std::uint64_t max_bytes_of(const Chunk& chunk) const;
  [[nodiscard]] const Statistics& statistics() const { return statistics_; }
  /// Messages of chunks that the sink refused.
  [[nodiscard]] std::uint64_t lost_messages() const { return lost_messages_; }

private:
  /// The records of one kind in the summary section.
  struct Group {
    Opcode opcode;
    std::vector<std::byte> records;
  };

  void require_open() const;
  void require_channels(const Chunk& chunk) const;
  void append(std::span<const std::byte> bytes);
  /// Reserves space for a record of `record_bytes`, for what close() writes after it, and for a last note.
  void reserve(std::uint64_t record_bytes, std::uint64_t more_closing_bytes);
  void append_metadata(const Metadata& metadata, bool is_last);
  void append_chunk(const Chunk& chunk);
  /// Builds the chunk record in `block_`. Returns the size of its compressed records.
  std::uint64_t build_chunk(const Chunk& chunk);
  /// Appends the message index records to `block_`. Returns the chunk index record.
  std::vector<std::byte> build_index(const Chunk& chunk, std::uint64_t compressed_size);
  [[nodiscard]] std::vector<std::byte> summary() const;
  [[nodiscard]] std::vector<std::byte> statistics_record() const;

  ByteSink& sink_;
  std::size_t chunk_size_bytes_;
  Compressor compressor_;
  Chunk current_;
  std::vector<std::byte> block_;  ///< bytes of the chunk that is being written
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  Group schema_group_{Opcode::schema, {}};
  Group channel_group_{Opcode::channel, {}};
  Group chunk_index_group_{Opcode::chunk_index, {}};
  Group metadata_index_group_{Opcode::metadata_index, {}};
  Group attachment_index_group_{Opcode::attachment_index, {}};
  Statistics statistics_;
  std::uint64_t bytes_written_ = 0;
  std::uint32_t data_crc_ = 0;
  std::uint64_t lost_messages_ = 0;
  bool is_closed_ = false;
};

}  // namespace sonopose::mcap
