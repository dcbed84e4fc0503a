#pragma once
/// \file
/// The contents of a screen and the keys of a keyboard, as values.

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::terminal {

/// The style of a text. Colours appear only if the terminal has them and the user wants them.
enum class Style : std::uint8_t { plain, bold, dim, heading, selected, good, warning, bad };

/// A part of a row, UTF-8.
struct Span {
  std::string text;
  Style style = Style::plain;
};

/// The parts of a row of the screen, from left to right.
using Row = std::vector<Span>;

struct Size {
  std::size_t columns = 80;
  std::size_t rows = 24;
};

/// A key: its ASCII character, or one of these.
enum class Key : int {
  enter = '\n',
  escape = 27,
  backspace = 127,
  up = 256,
  down,
  page_up,
  page_down,
  home,
  end,
  resized,  ///< not a key: the terminal has a new size
  other
};

}  // namespace sonopose::terminal
