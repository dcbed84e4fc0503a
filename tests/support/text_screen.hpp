#pragma once
/// \file
/// What a terminal shows: interprets the escape sequences that ncurses writes for TERM=xterm-256color.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::test {

class TextScreen {
public:
  TextScreen(std::size_t columns, std::size_t rows) { resize(columns, rows); }

  void feed(std::string_view bytes);
  /// Keeps the content that fits.
  void resize(std::size_t columns, std::size_t rows);

  /// Without the spaces at the end.
  [[nodiscard]] std::string line(std::size_t row) const;
  [[nodiscard]] std::string text() const;
  /// The first row that contains this; npos if none does.
  [[nodiscard]] std::size_t row_of(std::string_view part) const;

  [[nodiscard]] bool is_alternate() const { return alternate_; }  ///< smcup … rmcup
  [[nodiscard]] bool has_colour() const { return colour_; }       ///< a colour was chosen at some time
  [[nodiscard]] bool has_overflown() const {
    return overflown_;
  }  ///< a line was longer than the screen is wide
  [[nodiscard]] const std::string& unknown() const {
    return unknown_;
  }  ///< sequences that are not understood

private:
  void put(const std::string& character);
  void control(char byte);
  void sequence(char final, std::string_view parameters);
  void erase(std::size_t row, std::size_t from, std::size_t until);
  void scroll(std::size_t from, int lines);

  std::vector<std::vector<std::string>> cells_;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::size_t row_ = 0;
  std::size_t top_ = 0;  ///< of the scrolling region
  std::size_t bottom_ = 0;
  std::size_t column_ = 0;
  std::string pending_;  ///< the beginning of a sequence or character
  std::string last_;     ///< character, for repetition
  bool alternate_ = false;
  bool colour_ = false;
  bool overflown_ = false;
  std::string unknown_;
};

}  // namespace sonopose::test
