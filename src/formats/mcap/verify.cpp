#include "mcap/verify.hpp"

#include "mcap/compression.hpp"
#include "mcap/decoder.hpp"
#include "mcap/record_file.hpp"

#include <algorithm>

namespace sonopose::mcap {
namespace {

class Verification {
public:
  explicit Verification(const Reader& reader) : reader_{reader}, file_{reader.file()} {}

  std::vector<std::string> run() {
    std::uint64_t at = magic.size();
    data_crc_ = crc_of(0, at, 0);
    try {
      while (visit(at)) {
      }
      check_count();
    } catch (const FormatError& error) {
      // The start of the next record is unknown. The reader has already reported a cut file.
      if (reader_.damages().empty()) damages_.emplace_back(error.what());
    }
    return std::move(damages_);
  }

private:
  /// Checks the record at `at` and advances `at` to the next one. Returns false at the end of the data
  /// section.
  bool visit(std::uint64_t& at) {
    if (at == file_.size()) file_.place(at).fail("the file ends without DataEnd");
    const Prefix prefix = file_.prefix(at, file_.size());
    if (prefix.opcode == Opcode::data_end) {
      check(at, "DataEnd data_section_crc", number_at<std::uint32_t>(at + record_prefix_bytes), data_crc_,
            "does not match the data section");
      return false;
    }
    try {
      if (prefix.opcode == Opcode::attachment) check_attachment(at, prefix);
      if (prefix.opcode == Opcode::chunk) check_chunk(at, prefix);
      if (prefix.opcode == Opcode::message) ++message_count_;
    } catch (const FormatError& error) {
      damages_.emplace_back(error.what());
    }
    data_crc_ = crc_of(at, prefix.record_length(), data_crc_);
    at += prefix.record_length();
    return true;
  }

  void check_attachment(std::uint64_t at, const Prefix& prefix) {
    const std::uint64_t content_at = at + record_prefix_bytes;
    std::uint64_t covered =
        0;  // fields before the checksum; a later version of the format may add some after it
    const auto require = [&](std::uint64_t count) {
      if (count > prefix.length - covered) file_.place(at).fail("Attachment is too short for its crc");
    };
    const auto skip = [&](std::uint64_t count) {
      require(count);
      covered += count;
    };
    const auto skip_sized = [&]<class Size>(Size) {
      require(sizeof(Size));
      const auto size = number_at<Size>(content_at + covered);
      covered += sizeof(Size);
      skip(size);
    };
    skip(2 * sizeof(std::uint64_t));  // log_time, create_time
    skip_sized(std::uint32_t{});      // name
    skip_sized(std::uint32_t{});      // media_type
    skip_sized(std::uint64_t{});      // data
    require(sizeof(std::uint32_t));
    check(at, "Attachment crc", number_at<std::uint32_t>(content_at + covered),
          crc_of(content_at, covered, 0), "does not match the attachment");
  }

  /// Checks a chunk, unless a reader without index has already read it.
  void check_chunk(std::uint64_t at, const Prefix& prefix) {
    if (!reader_.contents().is_indexed) return;
    message_count_ += file_.load({Block::Kind::chunk, at, prefix.record_length(), {}, {}}).messages.size();
    const auto& blocks = reader_.contents().blocks;
    const auto known = std::ranges::lower_bound(blocks, at, {}, &Block::offset);
    if (known == blocks.end() || known->offset != at) file_.place(at).fail("the summary has no such chunk");
  }

  void check_count() {
    const std::uint64_t stated = reader_.statistics().message_count;
    if (!reader_.contents().is_indexed || !damages_.empty() || stated == message_count_) return;
    damages_.push_back(file_.name() + ": Statistics message_count is " + std::to_string(stated) +
                       ", but there are " + std::to_string(message_count_) + " messages");
  }

  void check(std::uint64_t at, const std::string& field, std::uint32_t stored, std::uint32_t computed,
             const std::string& what) {
    if (stored == 0 || stored == computed) return;
    damages_.push_back(file_.place(at).text() + ": " + field + " " + what);
  }

  template <std::unsigned_integral T>
  [[nodiscard]] T number_at(std::uint64_t at) const {
    return load<T>(file_.bytes(at, sizeof(T)).data());
  }

  /// Continues the checksum `before`, in pieces: a record may exceed the memory.
  [[nodiscard]] std::uint32_t crc_of(std::uint64_t at, std::uint64_t count, std::uint32_t before) const {
    constexpr std::uint64_t piece = 1U << 20U;
    while (count > 0) {
      const std::uint64_t now = std::min(count, piece);
      before = crc32(file_.bytes(at, now), before);
      at += now;
      count -= now;
    }
    return before;
  }

  const Reader& reader_;
  const RecordFile& file_;
  std::uint32_t data_crc_ = 0;
  std::uint64_t message_count_ = 0;
  std::vector<std::string> damages_;
};

}  // namespace

std::vector<std::string> verify(const Reader& reader) {
  return Verification(reader).run();
}

}  // namespace sonopose::mcap
