#include "support/text_screen.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace sonopose::test {
namespace {

/// Numbers of a list such as "3;40"; a missing one is 0.
std::vector<std::size_t> numbers_of(std::string_view text) {
  std::vector<std::size_t> numbers{0};
  for (const char byte : text) {
    if (byte == ';') {
      numbers.push_back(0);
    } else if (byte >= '0' && byte <= '9') {
      numbers.back() = numbers.back() * 10 + static_cast<std::size_t>(byte - '0');
    }
  }
  return numbers;
}

/// Length of the UTF-8 character that starts with this byte.
std::size_t length_of(char byte) {
  const auto code = static_cast<unsigned char>(byte);
  if (code < 0x80) return 1;
  if (code < 0xE0) return 2;
  return code < 0xF0 ? 3 : 4;
}

/// Length of the control sequence at the beginning; 0 if incomplete.
std::size_t sequence_length(std::string_view text) {
  if (text.size() < 2) return 0;
  if (text[1] == '(' || text[1] == ')') return text.size() < 3 ? 0 : 3;
  if (text[1] != '[') return 2;
  const auto* const final =
      std::find_if(text.begin() + 2, text.end(), [](char byte) { return byte >= '@' && byte <= '~'; });
  return final == text.end() ? 0 : static_cast<std::size_t>(final - text.begin()) + 1;
}

}  // namespace

void TextScreen::resize(std::size_t columns, std::size_t rows) {
  columns_ = columns;
  rows_ = rows;
  cells_.resize(rows);
  for (auto& line : cells_) line.resize(columns, " ");
  top_ = 0;
  bottom_ = rows - 1;
  row_ = std::min(row_, rows - 1);
  column_ = std::min(column_, columns);
}

void TextScreen::feed(std::string_view bytes) {
  pending_ += bytes;
  std::string_view rest = pending_;
  while (!rest.empty()) {
    std::size_t used = 1;
    if (rest.front() == '\x1b') {
      used = sequence_length(rest);
      if (used == 0) break;
      if (rest[1] == '[') {
        sequence(rest[used - 1], rest.substr(2, used - 3));
      } else if (rest[1] == 'M') {
        if (row_ == top_)
          scroll(top_, -1);
        else
          row_ -= std::min<std::size_t>(row_, 1);
      } else if (std::string_view("(=>78").find(rest[1]) == std::string_view::npos) {
        unknown_ += rest.substr(1, used - 1);
        unknown_ += ' ';
      }
    } else if (static_cast<unsigned char>(rest.front()) < 0x20) {
      control(rest.front());
    } else {
      used = length_of(rest.front());
      if (rest.size() < used) break;
      put(std::string(rest.substr(0, used)));
    }
    rest.remove_prefix(used);
  }
  pending_ = std::string(rest);
}

void TextScreen::put(const std::string& character) {
  last_ = character;
  if (column_ >= columns_) {
    overflown_ = overflown_ || alternate_;
    column_ = 0;
    row_ = std::min(row_ + 1, rows_ - 1);
  }
  cells_[row_][column_++] = character;
}

void TextScreen::control(char byte) {
  if (byte == '\r') column_ = 0;
  if (byte == '\b' && column_ > 0) --column_;
  if (byte == '\t') column_ = std::min((column_ / 8 + 1) * 8, columns_ - 1);
  if (byte != '\n') return;
  if (row_ == bottom_)
    scroll(top_, 1);
  else
    row_ = std::min(row_ + 1, rows_ - 1);
}

/// Scrolls the lines from this row to the end of the scrolling region up, or down if negative.
void TextScreen::scroll(std::size_t from, int lines) {
  const auto begin = cells_.begin() + static_cast<std::ptrdiff_t>(from);
  const auto end = cells_.begin() + static_cast<std::ptrdiff_t>(bottom_) + 1;
  const auto count = std::min<std::ptrdiff_t>(std::abs(lines), end - begin);
  std::rotate(begin, lines > 0 ? begin + count : end - count, end);
  const auto blank = lines > 0 ? end - count : begin;
  for (auto line = blank; line != blank + count; ++line) line->assign(columns_, " ");
}

void TextScreen::erase(std::size_t row, std::size_t from, std::size_t until) {
  for (std::size_t i = from; i < std::min(until, columns_); ++i) cells_[row][i] = " ";
}

void TextScreen::sequence(char final, std::string_view parameters) {
  const auto numbers = numbers_of(parameters);
  const std::size_t first = numbers.front();
  const std::size_t count = std::max<std::size_t>(first, 1);
  const auto to_row = [this](std::size_t row) { row_ = std::min(row, rows_ - 1); };
  const auto to_column = [this](std::size_t column) { column_ = std::min(column, columns_ - 1); };
  auto& line = cells_[row_];
  switch (final) {
    case 'H':
      to_row(count - 1);
      to_column(numbers.size() > 1 ? std::max<std::size_t>(numbers[1], 1) - 1 : 0);
      break;
    case 'A':
      row_ -= std::min(row_, count);
      break;
    case 'B':
      to_row(row_ + count);
      break;
    case 'C':
      to_column(column_ + count);
      break;
    case 'D':
      column_ -= std::min(column_, count);
      break;
    case 'G':
      to_column(count - 1);
      break;
    case 'd':
      to_row(count - 1);
      break;
    case 'J':
      if (first == 2) overflown_ = false;  // ignores what was drawn for the size before a resize
      if (first == 0) erase(row_, column_, columns_);
      for (std::size_t row = first == 0 ? row_ + 1 : 0; row < rows_; ++row) erase(row, 0, columns_);
      break;
    case 'K':
      if (first == 0) erase(row_, column_, columns_);
      if (first == 1) erase(row_, 0, column_ + 1);
      break;
    case 'X':
      erase(row_, column_, column_ + count);
      break;
    case '@':
      line.insert(line.begin() + static_cast<std::ptrdiff_t>(column_), count, " ");
      line.resize(columns_);
      break;
    case 'P':
      line.erase(line.begin() + static_cast<std::ptrdiff_t>(column_),
                 line.begin() + static_cast<std::ptrdiff_t>(std::min(column_ + count, columns_)));
      line.resize(columns_, " ");
      break;
    case 'b':
      for (std::size_t i = 0; i < count; ++i) put(std::string(last_));
      break;
    case 'm':
      for (const std::size_t number : numbers) {
        if ((number >= 30 && number <= 38) || (number >= 40 && number <= 48)) colour_ = true;
      }
      break;
    case 'h':
    case 'l':
      if (parameters == "?1049") alternate_ = final == 'h';
      break;
    case 'r':
      top_ = std::min(count - 1, rows_ - 1);
      bottom_ = numbers.size() > 1 ? std::clamp(numbers[1], top_ + 1, rows_) - 1 : rows_ - 1;
      row_ = column_ = 0;
      break;
    case 'S':
      scroll(top_, static_cast<int>(count));
      break;
    case 'T':
      scroll(top_, -static_cast<int>(count));
      break;
    case 'M':
      scroll(row_, static_cast<int>(count));
      break;
    case 'L':
      scroll(row_, -static_cast<int>(count));
      break;
    case 'Z':
      for (std::size_t i = 0; i < count && column_ > 0; ++i) column_ = (column_ - 1) / 8 * 8;
      break;
    case 't':  // window titles
      break;
    default:
      unknown_.append(parameters).append(1, final).append(1, ' ');
  }
}

std::string TextScreen::line(std::size_t row) const {
  std::string text;
  for (const std::string& cell : cells_.at(row)) text += cell;
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

std::string TextScreen::text() const {
  std::string text;
  for (std::size_t row = 0; row < rows_; ++row) text += line(row) + "\n";
  return text;
}

std::size_t TextScreen::row_of(std::string_view part) const {
  for (std::size_t row = 0; row < rows_; ++row) {
    if (line(row).find(part) != std::string::npos) return row;
  }
  return std::string::npos;
}

}  // namespace sonopose::test
