#include "mcap/verify.hpp"

#include "mcap/compression.hpp"
#include "mcap/decoder.hpp"

#include <algorithm>

namespace sonopose::mcap {
namespace {

constexpr std::uint64_t crc_bytes = sizeof(std::uint32_t);

class Verification {
public:
  explicit Verification(const RecordFile& file) : file_{file} {}

  std::vector<std::string> run() {
    std::uint64_t at = magic.size();
    data_crc_ = crc_of(0, at, 0);
    try {
      while (at < file_.size()) {
        const Prefix prefix = file_.prefix(at, file_.size());
        if (prefix.opcode == Opcode::data_end) {
          check(at, "DataEnd data_section_crc", number_at(at + record_prefix_bytes), data_crc_,
                "does not match the data section");
          break;
        }
        if (prefix.opcode == Opcode::attachment) check_attachment(at, prefix);
        data_crc_ = crc_of(at, prefix.record_length(), data_crc_);
        at += prefix.record_length();
      }
    } catch (const FormatError&) {  // NOLINT(bugprone-empty-catch): a cut file, which the reader names
    }
    return std::move(damages_);
  }

private:
  void check_attachment(std::uint64_t at, const Prefix& prefix) {
    if (prefix.length < crc_bytes) file_.place(at).fail("Attachment is too short for its crc");
    const std::uint64_t covered = prefix.length - crc_bytes;
    const std::uint64_t content_at = at + record_prefix_bytes;
    check(at, "Attachment crc", number_at(content_at + covered), crc_of(content_at, covered, 0),
          "does not match the attachment");
  }

  void check(std::uint64_t at, const std::string& field, std::uint32_t stored, std::uint32_t computed,
             const std::string& what) {
    if (stored == 0 || stored == computed) return;
    damages_.push_back(file_.place(at).text() + ": " + field + " " + what);
  }

  [[nodiscard]] std::uint32_t number_at(std::uint64_t at) const {
    return load<std::uint32_t>(file_.bytes(at, crc_bytes).data());
  }

  /// Continued from `before`, in pieces: a record may be larger than the memory.
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

  const RecordFile& file_;
  std::uint32_t data_crc_ = 0;
  std::vector<std::string> damages_;
};

}  // namespace

std::vector<std::string> verify(const RecordFile& file) {
  return Verification(file).run();
}

}  // namespace sonopose::mcap
