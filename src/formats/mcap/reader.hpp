#pragma once
/// \file
/// Reads MCAP files of any origin.

#include "mcap/byte_source.hpp"
#include "mcap/contents.hpp"
#include "mcap/format_error.hpp"
#include "mcap/records.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace sonopose::mcap {

class RecordFile;

/// A recording in one file or several. Uses the index if a file has one. A file without index, or a cut one,
/// is read from start to end once. Damaged parts are left out and named in `damages()`.
class Reader {
public:
  /// Throws files::IoError if the file cannot be read, and FormatError if it is not an MCAP file.
  explicit Reader(const std::filesystem::path& file);
  /// Channels that are alike in several files are one. Profile and library are those of the first file.
  explicit Reader(const std::vector<std::filesystem::path>& files);
  explicit Reader(std::unique_ptr<ByteSource> source);
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Name of the file, or of the first one and the number of the others.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t size_bytes() const;
  [[nodiscard]] const Contents& contents() const { return contents_; }
  [[nodiscard]] const std::map<std::uint16_t, Schema>& schemas() const { return contents_.schemas; }
  [[nodiscard]] const std::map<std::uint16_t, Channel>& channels() const { return contents_.channels; }
  [[nodiscard]] const Statistics& statistics() const { return contents_.statistics; }
  /// Descriptions of damage in the file; empty for a sound one.
  [[nodiscard]] const std::vector<std::string>& damages() const { return contents_.damages; }

  /// Reads all metadata records, in file order. Throws FormatError.
  [[nodiscard]] std::vector<Metadata> metadata() const;
  /// Reads the sound metadata records, and describes damaged ones in `damages`.
  [[nodiscard]] std::vector<Metadata> metadata(std::vector<std::string>& damages) const;

  /// Reads the content of an attachment record. Throws FormatError, also if its checksum does not match.
  [[nodiscard]] std::vector<std::byte> attachment(const Extent& record) const;

  [[nodiscard]] const RecordFile& file(std::size_t number = 0) const { return *files_.at(number); }
  /// The id in `channels()` of a channel of one of the files; empty if the file has no such channel.
  [[nodiscard]] std::optional<std::uint16_t> channel_id(std::size_t file, std::uint16_t id) const;

private:
  void add(std::unique_ptr<ByteSource> source);

  std::string name_;
  std::vector<std::unique_ptr<RecordFile>> files_;
  Contents contents_;
  std::vector<std::map<std::uint16_t, std::uint16_t>> channel_ids_;  ///< for each file
};

/// A choice of messages, and their order.
struct Selection {
  enum class Order {
    log_time,  ///< log time, then file order
    file,      ///< file order; several files are merged by log time
  };
  enum class Damaged { refuse, skip };

  std::function<bool(const Channel&)> channel = {};                  ///< filter of channels; empty: all
  std::uint64_t start_ns = 0;                                        ///< first log time
  std::uint64_t end_ns = std::numeric_limits<std::uint64_t>::max();  ///< last log time, inclusive
  Order order = Order::log_time;
  Damaged damaged = Damaged::refuse;    ///< treatment of a chunk that turns out to be damaged
  std::uint64_t max_bytes = 1U << 30U;  ///< limit of chunks in memory, with the places of their messages
};

/// The messages of a selection, one at a time. Holds chunks that overlap in time in memory, up to a limit.
class Messages {
public:
  /// The reader must outlive the messages.
  explicit Messages(const Reader& reader, Selection selection = {});
  ~Messages();
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  /// The next message; its data are valid until the next call. Empty at the end. Throws FormatError if a
  /// chunk is damaged, or if overlapping chunks exceed the limit of memory.
  std::optional<Message> next();

  /// Descriptions of the damaged chunks that were skipped.
  [[nodiscard]] const std::vector<std::string>& skipped() const;

private:
  class Merge;
  std::unique_ptr<Merge> merge_;
};

}  // namespace sonopose::mcap
