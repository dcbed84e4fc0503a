#include "monitor/screen.hpp"

#include "monitor/screen_page.hpp"
#include "monitor/screen_table.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace sonopose::monitor {
namespace {

using terminal::Key;
using terminal::Row;
using terminal::Style;

constexpr std::string_view table_keys =
    "w worst  a address  e error  t trust  l latency  ↑↓  Enter page  c clear  q quit";
constexpr std::string_view page_keys = "↑↓ PgUp PgDn  Enter or Esc: the table  c clear the counters  q quit";

constexpr std::array<std::pair<char, Order>, 5> order_keys{{{'w', Order::worst},
                                                            {'a', Order::address},
                                                            {'e', Order::error},
                                                            {'t', Order::trust},
                                                            {'l', Order::latency}}};

/// Moves `row` by `by`, within 0 … `last`.
std::size_t moved(std::size_t row, std::ptrdiff_t by, std::size_t last) {
  const std::ptrdiff_t target = static_cast<std::ptrdiff_t>(row) + by;
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(target, 0, static_cast<std::ptrdiff_t>(last)));
}

}  // namespace

void Screen::show(std::vector<observation::BeaconView> views, std::vector<std::string> warnings) {
  const auto before = std::exchange(views_, std::move(views));
  warnings_ = std::move(warnings);
  sort(views_, order_);
  if (selected_) keep_rows(before);
}

void Screen::keep_rows(const std::vector<observation::BeaconView>& before) {
  std::map<BeaconAddress, std::size_t> rows;
  for (const observation::BeaconView& view : before) rows.emplace(view.address, rows.size());
  const auto row_of = [&rows](BeaconAddress address) {
    const auto found = rows.find(address);
    return found == rows.end() ? rows.size() : found->second;
  };
  std::stable_sort(views_.begin(), views_.end(),
                   [&](const auto& a, const auto& b) { return row_of(a.address) < row_of(b.address); });
  const auto is_selected = [this](const auto& view) { return view.address == selected_; };
  if (std::any_of(views_.begin(), views_.end(), is_selected)) return;
  // The selected beacon is gone: its row now shows the next one.
  if (views_.empty()) {
    selected_.reset();
  } else {
    selected_ = views_[std::min(row_of(*selected_), views_.size() - 1)].address;
  }
}

Command Screen::on_key(Key key) {
  const bool on_page = page_.has_value();
  const auto page_rows = static_cast<std::ptrdiff_t>(std::max<std::size_t>(body_rows(), 2) - 1);
  constexpr std::ptrdiff_t far = 1'000'000;
  if (key == Key{'q'}) return Command::quit;
  if (key == Key{'c'}) return Command::clear_counters;
  if (key == Key{'?'}) shows_keys_ = !shows_keys_;
  for (const auto& [character, order] : order_keys) {
    if (key == Key{character}) sort_by(order);
  }
  switch (key) {
    case Key::up:
      move_by(-1);
      break;
    case Key::down:
      move_by(1);
      break;
    case Key::page_up:
      move_by(-page_rows);
      break;
    case Key::page_down:
      move_by(page_rows);
      break;
    case Key::home:
      move_by(-far);
      if (!on_page) {
        selected_.reset();
        sort(views_, order_);
      }
      break;
    case Key::end:
      move_by(far);
      break;
    case Key::enter:
      page_row_ = 0;
      if (on_page) {
        page_.reset();
      } else if (!views_.empty()) {
        page_ = views_[selected_index()].address;
      }
      break;
    case Key::escape:
    case Key::backspace:
      page_.reset();
      break;
    default:
      break;
  }
  return Command::none;
}

void Screen::sort_by(Order order) {
  order_ = order;
  sort(views_, order_);
}

void Screen::move_by(std::ptrdiff_t rows) {
  if (page_) {
    page_row_ = moved(page_row_, rows, 1000);  // page_lines() limits it
  } else if (!views_.empty()) {
    selected_ = views_[moved(selected_index(), rows, views_.size() - 1)].address;
  }
}

std::size_t Screen::selected_index() const {
  if (!selected_) return 0;
  const auto found = std::find_if(views_.begin(), views_.end(), [this](const observation::BeaconView& view) {
    return view.address == *selected_;
  });
  return found == views_.end() ? 0 : static_cast<std::size_t>(found - views_.begin());
}

std::size_t Screen::body_rows() const {
  return size_.rows > table_begin + footer_rows ? size_.rows - table_begin - footer_rows : 0;
}

std::vector<Row> Screen::lines(terminal::Size size) {
  size_ = size;
  const std::vector<Row> body = page_ ? page_lines() : table_lines();
  std::vector<Row> lines{{{fitted(title(), size.columns), Style::bold}}};
  lines.insert(lines.end(), body.begin(), body.end());
  lines.resize(std::max(size.rows, footer_rows) - footer_rows);
  lines.push_back(hint_line());
  lines.push_back({{fitted(message_, size.columns), Style::plain}});
  if (lines.size() > size.rows)
    lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(size.rows));
  return lines;
}

std::string Screen::title() const {
  if (page_) return fmt::format("beacon {}   Esc: the table   sonopose-monitor", *page_);
  const auto count = [this](int min, int below) {
    return std::count_if(views_.begin(), views_.end(), [&](const observation::BeaconView& view) {
      return severity_of(view) >= min && severity_of(view) < below;
    });
  };
  const std::string_view order = order_words[static_cast<std::size_t>(order_)];
  std::string text = fmt::format("{} by {}{}", text::count_text(views_.size(), "beacon"), order,
                                 selected_ ? ", held until Home" : "");
  const std::size_t rows = body_rows();
  if (views_.size() > rows) {
    text += fmt::format(", rows {}-{}", first_row_ + 1, std::min(first_row_ + rows, views_.size()));
  }
  text += fmt::format("   {} bad, {} warned   sonopose-monitor", count(bad_severity, 1000),
                      count(1, bad_severity));
  return text;
}

std::vector<Row> Screen::table_lines() {
  std::vector<Row> lines{table_heading(size_.columns)};
  const std::size_t rows = body_rows();
  if (views_.empty()) {
    lines.push_back({{fitted("no beacon yet; sonopose-doctor says why", size_.columns), Style::dim}});
    // Without a beacon there is no page for them.
    for (Row& line : wrapped(warnings_, size_.columns)) lines.push_back(std::move(line));
    lines.resize(std::min(lines.size(), rows + 1));
    return lines;
  }
  const std::size_t selected = selected_index();
  // Scroll only as far as the selected row and the size require.
  if (selected >= first_row_ + rows) first_row_ = selected + 1 - rows;
  first_row_ = std::min({first_row_, selected, views_.size() - std::min(views_.size(), rows)});
  for (std::size_t i = first_row_; i < std::min(first_row_ + rows, views_.size()); ++i) {
    lines.push_back(table_row(views_[i], size_.columns, i == selected));
  }
  return lines;
}

std::vector<Row> Screen::page_lines() {
  const auto found = std::find_if(views_.begin(), views_.end(), [this](const observation::BeaconView& view) {
    return view.address == *page_;
  });
  if (found == views_.end()) return {{{fitted("the beacon is gone", size_.columns), Style::dim}}};
  std::vector<Row> lines = page_of(*found, warnings_, size_.columns);
  const std::size_t rows = body_rows() + 1;  // a page has no heading
  page_row_ = std::min(page_row_, lines.size() > rows ? lines.size() - rows : 0);
  lines.erase(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(page_row_));
  lines.resize(std::min(lines.size(), rows));
  return lines;
}

Row Screen::hint_line() const {
  if (shows_keys_) return {{fitted(page_ ? page_keys : table_keys, size_.columns), Style::dim}};
  if (warnings_.empty()) return {{fitted("? keys   q quit", size_.columns), Style::dim}};
  const std::string first = "warning: " + warnings_.front();
  std::string more;
  if (warnings_.size() > 1) {
    more = fmt::format(" (and {} more: Enter)", warnings_.size() - 1);
  } else if (columns_of(first) > size_.columns && !page_) {
    more = " (all: Enter)";
  }
  const std::size_t left = size_.columns - std::min(size_.columns, columns_of(more));
  return {{fitted(first, left), Style::warning}, {fitted(more, size_.columns), Style::warning}};
}

}  // namespace sonopose::monitor
