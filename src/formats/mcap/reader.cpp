#include "mcap/reader.hpp"

#include "mcap/append.hpp"
#include "mcap/compression.hpp"
#include "mcap/record_file.hpp"
#include "mcap/scan.hpp"
#include "mcap/summary.hpp"
#include <sonopose/text/count_text.hpp>

#include <algorithm>
#include <utility>

namespace sonopose::mcap {

namespace {

Contents read_contents(const RecordFile& file) {
  SummaryReading summary = read_summary(file);
  if (summary.contents) return std::move(*summary.contents);
  Contents contents = scan(file, std::move(summary.record_offsets));
  const std::uint64_t found = contents.statistics.message_count;
  const std::uint64_t stated = summary.message_count.value_or(found + contents.lost_messages);
  const bool has_reported = !contents.damages.empty();  // a cut file, or lost messages
  if (!has_reported && !summary.damage.empty()) contents.add_damage(summary.damage);
  if (!has_reported && stated != found) {
    contents.add_damage(file.name() + ": Statistics message_count is " + std::to_string(stated) +
                        ", but there are " + std::to_string(found) + " messages");
  }
  if (summary.message_count) {
    contents.lost_messages = std::max(contents.lost_messages, stated - std::min(stated, found));
    contents.has_uncounted_loss = false;
  }
  return contents;
}

/// Also returns a description of damage that leaves the record usable.
std::pair<Metadata, std::optional<std::string>> read_metadata(const Reader& reader, const Extent& record) {
  const RecordFile& file = reader.file(record.file);
  const Bytes content = file.content(record, Opcode::metadata);
  Fields fields(content, Opcode::metadata, file.place(record.offset));
  Metadata metadata = decode_metadata(fields);
  return {std::move(metadata), fields.repeated_key()};
}

}  // namespace

Reader::Reader(const std::filesystem::path& file) : Reader(std::vector{file}) {}

Reader::Reader(const std::vector<std::filesystem::path>& files) {
  for (const auto& file : files) add(std::make_unique<FileSource>(file));
  name_ = text::first_of(files.front().string(), files.size());
}

Reader::Reader(std::unique_ptr<ByteSource> source) {
  name_ = source->name();
  add(std::move(source));
}

Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

void Reader::add(std::unique_ptr<ByteSource> source) {
  files_.push_back(std::make_unique<RecordFile>(std::move(source)));
  Contents contents = read_contents(*files_.back());
  channel_ids_.emplace_back();
  if (files_.size() > 1) {
    channel_ids_.back() = append(contents_, std::move(contents), *files_.back(), files_.size() - 1);
    return;
  }
  contents_ = std::move(contents);
  for (const auto& [id, channel] : contents_.channels) channel_ids_.back().emplace(id, id);
}

std::uint64_t Reader::size_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& file : files_) bytes += file->size();
  return bytes;
}

std::optional<std::uint16_t> Reader::channel_id(std::size_t file, std::uint16_t id) const {
  const auto found = channel_ids_.at(file).find(id);
  return found == channel_ids_.at(file).end() ? std::nullopt : std::optional(found->second);
}

Bytes Reader::attachment(const Extent& record) const {
  const Place place = file(record.file).place(record.offset);
  Bytes content = file(record.file).content(record, Opcode::attachment);
  const AttachmentFields fields = decode_attachment(Fields(content, Opcode::attachment, place));
  if (fields.crc != 0 && fields.crc != crc32(std::span(content).first(fields.crc_at))) {
    place.fail("Attachment crc does not match the attachment");
  }
  return content;
}

std::vector<Metadata> Reader::metadata() const {
  std::vector<Metadata> metadata;
  MemoryLimit memory;
  for (const Extent& record : contents_.metadata) {
    metadata.push_back(read_metadata(*this, record).first);
    memory.reserve(memory_of(metadata.back()), "the metadata take", file(record.file).place(record.offset));
  }
  return metadata;
}

std::vector<Metadata> Reader::metadata(std::vector<std::string>& damages) const {
  std::vector<Metadata> metadata;
  MemoryLimit memory;
  for (const Extent& record : contents_.metadata) {
    try {
      auto [one, damage] = read_metadata(*this, record);
      memory.reserve(memory_of(one), "the metadata take", file(record.file).place(record.offset));
      metadata.push_back(std::move(one));
      if (damage) damages.push_back(std::move(*damage));
    } catch (const FormatError& error) {
      damages.emplace_back(error.what());
    }
  }
  return metadata;
}

}  // namespace sonopose::mcap
