#include "mcap/reader.hpp"

#include "mcap/record_file.hpp"
#include "mcap/scan.hpp"
#include "mcap/summary.hpp"

#include <utility>

namespace sonopose::mcap {

namespace {

Contents read_contents(const RecordFile& file) {
  std::string damage;
  try {
    if (auto contents = read_summary(file)) return std::move(*contents);
  } catch (const FormatError& error) {
    damage = error.what();
  }
  Contents contents = scan(file);
  // The scan has already reported a cut file.
  if (!damage.empty() && contents.damages.empty()) contents.add_damage(damage);
  return contents;
}

/// Also returns a description of damage that leaves the record usable.
std::pair<Metadata, std::optional<std::string>> read_metadata(const RecordFile& file, const Extent& record) {
  const Bytes content = file.content(record, Opcode::metadata);
  Fields fields(content, Opcode::metadata, file.place(record.offset));
  Metadata metadata = decode_metadata(fields);
  return {std::move(metadata), fields.repeated_key()};
}

}  // namespace

Reader::Reader(const std::filesystem::path& file) : Reader(std::make_unique<FileSource>(file)) {}

Reader::Reader(std::unique_ptr<ByteSource> source)
    : file_{std::make_unique<RecordFile>(std::move(source))}, contents_{read_contents(*file_)} {}

Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

const std::string& Reader::name() const {
  return file_->name();
}

std::uint64_t Reader::size_bytes() const {
  return file_->size();
}

std::vector<Metadata> Reader::metadata() const {
  std::vector<Metadata> metadata;
  MemoryLimit memory;
  for (const Extent& record : contents_.metadata) {
    metadata.push_back(read_metadata(*file_, record).first);
    memory.reserve(memory_of(metadata.back()), "the metadata take", file_->place(record.offset));
  }
  return metadata;
}

std::vector<Metadata> Reader::metadata(std::vector<std::string>& damages) const {
  std::vector<Metadata> metadata;
  MemoryLimit memory;
  for (const Extent& record : contents_.metadata) {
    try {
      auto [one, damage] = read_metadata(*file_, record);
      memory.reserve(memory_of(one), "the metadata take", file_->place(record.offset));
      metadata.push_back(std::move(one));
      if (damage) damages.push_back(std::move(*damage));
    } catch (const FormatError& error) {
      damages.emplace_back(error.what());
    }
  }
  return metadata;
}

}  // namespace sonopose::mcap
