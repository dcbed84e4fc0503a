#include "terminal/terminal.hpp"

#include <clocale>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <langinfo.h>
#include <string>
#include <string_view>
#include <unistd.h>

// Functions only: the macros would replace names of this project.
#define NCURSES_NOMACROS
#define NCURSES_WIDECHAR 1
#include <curses.h>

namespace sonopose::terminal {
namespace {

bool has_value(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

/// Selects UTF-8 for texts, whatever the locale; numbers keep their format.
void choose_utf8() {
  const char* const locale = std::setlocale(LC_CTYPE, "");
  if (locale != nullptr && std::string_view(::nl_langinfo(CODESET)) == "UTF-8") return;
  std::setlocale(LC_CTYPE, "C.UTF-8");
}

/// Returns a string of the terminal's description, without the delays ("$<5>") that only real terminals need.
std::string capability(const char* name) {
  const char* const found = ::tigetstr(name);
  // NOLINTNEXTLINE(*-reinterpret-cast, performance-no-int-to-ptr): -1 if the name is not that of a string
  if (found == nullptr || found == reinterpret_cast<const char*>(-1)) return {};
  std::string text = found;
  for (std::size_t at = 0; (at = text.find("$<")) != std::string::npos;) {
    const std::size_t end = text.find('>', at);
    text.erase(at, end == std::string::npos ? end : end - at + 1);
  }
  return text;
}

/// Returns the sequence that leaves the full-screen mode: plain style, visible cursor, previous cursor keys,
/// earlier content.
std::string exit_sequence() {
  std::string sequence;
  for (const char* name : {"sgr0", "op", "cnorm", "rmkx", "rmcup"}) sequence += capability(name);
  return sequence + "\r";
}

Key key_of(int code) {
  switch (code) {
    case KEY_UP:
      return Key::up;
    case KEY_DOWN:
      return Key::down;
    case KEY_PPAGE:
      return Key::page_up;
    case KEY_NPAGE:
      return Key::page_down;
    case KEY_HOME:
      return Key::home;
    case KEY_END:
      return Key::end;
    case KEY_RESIZE:
      return Key::resized;
    case KEY_ENTER:
    case '\r':
      return Key::enter;
    case KEY_BACKSPACE:
    case '\b':
      return Key::backspace;
    default:
      return code >= 0 && code <= 127 ? static_cast<Key>(code) : Key::other;
  }
}

/// Removes and returns the next character of a UTF-8 text. Invalid or unprintable characters become U+FFFD.
wchar_t next_character(std::string_view& text) {
  std::mbstate_t state{};
  wchar_t character = 0;
  const std::size_t used = std::mbrtowc(&character, text.data(), text.size(), &state);
  const bool good = used > 0 && used <= text.size();
  text.remove_prefix(good ? used : 1);
  return good && ::wcwidth(character) >= 0 ? character : L'\uFFFD';
}

/// Returns the characters of a UTF-8 text that fit into the remaining columns.
std::wstring wide(std::string_view text, int& columns_left) {
  std::wstring characters;
  while (!text.empty()) {
    const wchar_t character = next_character(text);
    columns_left -= ::wcwidth(character);
    if (columns_left < 0) break;  // would continue on the next line
    characters += character;
  }
  return characters;
}

}  // namespace

bool is_screen() {
  const char* const type = std::getenv("TERM");
  return ::isatty(STDIN_FILENO) == 1 && ::isatty(STDOUT_FILENO) == 1 && has_value("TERM") &&
         std::strcmp(type, "dumb") != 0;
}

/// The full-screen mode of ncurses.
class Terminal::Curses {
public:
  Curses() {
    choose_utf8();
    if (!has_value("ESCDELAY")) ::set_escdelay(100);  // a slow line delivers an arrow key in parts
    screen_ = ::newterm(nullptr, stdout, stdin);
    if (screen_ == nullptr) {
      throw NoScreen(std::string("TERM=") + std::getenv("TERM") + ": unknown type of terminal");
    }
    ::cbreak();
    ::noecho();
    ::nonl();
    ::curs_set(0);
    ::keypad(stdscr, true);
    ::nodelay(stdscr, true);
    coloured_ = !has_value("NO_COLOR") && ::has_colors() && ::start_color() == OK;
    if (coloured_) {
      ::use_default_colors();
      ::init_pair(good_pair, COLOR_GREEN, -1);
      ::init_pair(warning_pair, COLOR_YELLOW, -1);
      ::init_pair(bad_pair, COLOR_RED, -1);
    }
  }
  Curses(const Curses&) = delete;
  Curses& operator=(const Curses&) = delete;
  ~Curses() {
    ::endwin();
    ::delscreen(screen_);
  }

  void draw(const std::vector<Row>& rows) {
    ::werase(stdscr);
    for (std::size_t row = 0; row < rows.size() && static_cast<int>(row) < ::getmaxy(stdscr); ++row) {
      draw(static_cast<int>(row), rows[row]);
    }
    ::wrefresh(stdscr);
  }

private:
  static constexpr short good_pair = 1;
  static constexpr short warning_pair = 2;
  static constexpr short bad_pair = 3;

  [[nodiscard]] attr_t attributes(Style style) const {
    const auto colour = [this](int pair) { return coloured_ ? static_cast<attr_t>(COLOR_PAIR(pair)) : 0; };
    switch (style) {
      case Style::plain:
        return A_NORMAL;
      case Style::bold:
        return A_BOLD;
      case Style::dim:
        return A_DIM;
      case Style::heading:
        return A_BOLD | A_UNDERLINE;
      case Style::selected:
        return A_REVERSE;
      case Style::good:
        return colour(good_pair);
      case Style::warning:
        return colour(warning_pair);
      case Style::bad:
        return colour(bad_pair) | A_BOLD;
    }
    return A_NORMAL;
  }

  void draw(int row, const Row& line) {
    int columns_left = ::getmaxx(stdscr);
    ::wmove(stdscr, row, 0);
    for (const Span& span : line) {
      const std::wstring characters = wide(span.text, columns_left);
      ::wattrset(stdscr, static_cast<int>(attributes(span.style)));
      ::waddnwstr(stdscr, characters.data(), static_cast<int>(characters.size()));
    }
    ::wattrset(stdscr, A_NORMAL);
  }

  SCREEN* screen_ = nullptr;
  bool coloured_ = false;
};

Terminal::Terminal() {
  errors_ = std::make_unique<ErrorLines>();
  // Precedes ncurses, which changes the line modes.
  crash_restore_ = std::make_unique<CrashRestore>(STDOUT_FILENO, errors_->original_fd());
  curses_ = std::make_unique<Curses>();
  crash_restore_->leave_with(exit_sequence());
}

Terminal::~Terminal() {
  // Curses ends first, so that standard error appears on the restored terminal.
  curses_.reset();
  crash_restore_.reset();
}

std::optional<Key> Terminal::key() {
  const int code = ::wgetch(stdscr);
  if (code == ERR) return std::nullopt;
  constexpr int ctrl_l = 'L' & 0x1F;
  if (code == ctrl_l) ::clearok(curscr, true);  // redraws everything, in case another program has written
  return key_of(code);
}

Size Terminal::size() const {
  return {static_cast<std::size_t>(::getmaxx(stdscr)), static_cast<std::size_t>(::getmaxy(stdscr))};
}

void Terminal::draw(const std::vector<Row>& rows) {
  curses_->draw(rows);
}

}  // namespace sonopose::terminal
