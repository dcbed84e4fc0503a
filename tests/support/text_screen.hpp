#pragma once
/// \file
/// Content of a terminal: interprets the escape sequences that ncurses writes for TERM=xterm-256color.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sonopose::test {

class TextScreen {
public:
  TextScreen(std::size_t columns, std::size_t rows) { resize(columns, rows); }

  void feed(std::string_view bytes);
  /// Changes the size and keeps the content that fits.
  void resize(std::size_t columns, std::size_t rows);

  /// Text of a row without trailing spaces.
  [[nodiscard]] std::string line(std::size_t row) const;
  [[nodiscard]] std::string text() const;
  /// First row that contains `part`; npos if none does.
  [[nodiscard]] std::size_t row_of(std::string_view part) const;

  [[nodiscard]] bool is_alternate() const { return alternate_; }   ///< between smcup and rmcup
  [[nodiscard]] bool has_colour() const { return colour_; }        ///< a colour was selected at some time
  [[nodiscard]] bool has_overflown() const { return overflown_; }  ///< a line exceeded the width
  [[nodiscard]] const std::string& unknown() const {
    return unknown_;
  }  ///< sequences that were not understood

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
  std::size_t top_ = 0;  ///< first row of the scrolling region
  std::size_t bottom_ = 0;
  std::size_t column_ = 0;
  std::string pending_;  ///< incomplete sequence or character
  std::string last_;     ///< last character, for repetition
  bool alternate_ = false;
  bool colour_ = false;
  bool overflown_ = false;
  std::string unknown_;
};

}  // namespace sonopose::test
