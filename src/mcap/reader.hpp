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

/// Uses the index where the file has one. A file without an index, or one that was cut, is read from start to
/// end once; what is damaged is left out and named in `damages()`.
class Reader {
public:
  /// Throws files::IoError if the file cannot be read, and FormatError if it is not an MCAP file.
  explicit Reader(const std::filesystem::path& file);
  explicit Reader(std::unique_ptr<ByteSource> source);
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] std::uint64_t size_bytes() const;
  [[nodiscard]] const Contents& contents() const { return contents_; }
  [[nodiscard]] const std::map<std::uint16_t, Schema>& schemas() const { return contents_.schemas; }
  [[nodiscard]] const std::map<std::uint16_t, Channel>& channels() const { return contents_.channels; }
  [[nodiscard]] const Statistics& statistics() const { return contents_.statistics; }
  /// What is wrong with the file, in words; empty for a sound one.
  [[nodiscard]] const std::vector<std::string>& damages() const { return contents_.damages; }

  /// All metadata records, in the order of the file. Throws FormatError.
  [[nodiscard]] std::vector<Metadata> metadata() const;
  /// The same without those that are damaged, which are named in `damages`.
  [[nodiscard]] std::vector<Metadata> metadata(std::vector<std::string>& damages) const;

  [[nodiscard]] const RecordFile& file() const { return *file_; }

private:
  std::unique_ptr<RecordFile> file_;
  Contents contents_;
};

/// Which messages, and in which order.
struct Selection {
  enum class Order {
    log_time,  ///< then the order of the file
    file,
  };
  enum class Damaged { refuse, skip };

  std::function<bool(const Channel&)> channel = {};                  ///< empty: all
  std::uint64_t start_ns = 0;                                        ///< log times from here
  std::uint64_t end_ns = std::numeric_limits<std::uint64_t>::max();  ///< to here, inclusive
  Order order = Order::log_time;
  Damaged damaged = Damaged::refuse;     ///< what to do with a chunk that turns out to be damaged
  std::uint64_t most_bytes = 1U << 30U;  ///< of chunks in memory, with the places of their messages
};

/// The messages of a selection, one after the other. Its memory holds the chunks that overlap in time, up to
/// a limit.
class Messages {
public:
  /// The reader must outlive the messages.
  explicit Messages(const Reader& reader, Selection selection = {});
  ~Messages();
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;
  Messages(Messages&&) = delete;
  Messages& operator=(Messages&&) = delete;

  /// The next message; its data are valid until the next call. Empty at the end. Throws FormatError if a
  /// chunk is damaged or more chunks overlap in time than memory may hold.
  std::optional<Message> next();

  /// The damaged chunks that were skipped, in words.
  [[nodiscard]] const std::vector<std::string>& skipped() const;

private:
  class Merge;
  std::unique_ptr<Merge> merge_;
};

}  // namespace sonopose::mcap
