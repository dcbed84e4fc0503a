#include "files/line_reader.hpp"

#include "files/error.hpp"
#include "files/input_file.hpp"
#include "files/missing.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

namespace sonopose::files {

namespace {

constexpr std::size_t max_line_bytes = std::size_t{1} << 18U;  ///< bytes; also the size of the buffer
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

std::FILE* open_stream(const std::filesystem::path& file) {
  Descriptor opened = open_input(file);
  std::FILE* const stream = ::fdopen(opened.number(), "rb");
  if (stream == nullptr) throw IoError(opening_error(file.string(), errno));
  opened.release();
  return stream;
}

}  // namespace

LineReader::LineReader(const std::filesystem::path& file)
    : name_{file.string()}, file_{open_stream(file)}, buffer_(max_line_bytes) {
  std::error_code not_known;
  const auto size = std::filesystem::file_size(file, not_known);
  if (!not_known) file_size_ = size;
  refill();
  const std::string_view text(buffer_.data(), end_);
  if (text.starts_with(byte_order_mark)) begin_ = byte_order_mark.size();
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw IoError(name_ + ": is UTF-16; convert it: iconv -f UTF-16 -t UTF-8 \"" + name_ + "\" > utf-8.csv");
  }
  if (text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos)
    line_end_ = '\r';
}

std::optional<std::string_view> LineReader::next() {
  std::size_t searched = 0;  // bytes searched for a line ending so far
  const void* newline = nullptr;
  do {
    newline = std::memchr(buffer_.data() + begin_ + searched, line_end_, end_ - begin_ - searched);
    searched = end_ - begin_;
  } while (newline == nullptr && refill());
  if (newline == nullptr && searched == 0) return std::nullopt;
  const char* const first = buffer_.data() + begin_;
  const std::size_t size =
      newline == nullptr ? searched : static_cast<std::size_t>(static_cast<const char*>(newline) - first);
  begin_ += newline == nullptr ? size : size + 1;
  ++number_;
  const std::string_view line(first, size);
  return line.ends_with('\r') ? line.substr(0, size - 1) : line;
}

bool LineReader::refill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (end_ == buffer_.size()) {
    throw IoError(name_ + ":" + std::to_string(number_ + 1) +
                  ": the line is too long, this is not a text file");
  }
  const std::size_t count = std::fread(buffer_.data() + end_, 1, buffer_.size() - end_, file_.get());
  if (std::ferror(file_.get()) != 0) throw IoError(name_ + ": cannot be read: " + std::strerror(errno));
  end_ += count;
  return count > 0;
}

}  // namespace sonopose::files
