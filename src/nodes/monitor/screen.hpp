#pragma once
/// \file
/// The monitor's screen: its contents and its keys. Values in, lines out.

#include "monitor/order.hpp"
#include "observation/beacon_observer.hpp"
#include "terminal/text.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::monitor {

/// Request of a key to the program.
enum class Command : std::uint8_t { none, quit, clear_counters };

/// A title, a table or the page of one beacon, a line of warnings or keys, and a line for the last message.
class Screen {
public:
  /// Sets the beacons and warnings to show. While a row is selected, the beacons keep their rows and new ones
  /// come last.
  void show(std::vector<observation::BeaconView> views, std::vector<std::string> warnings);

  /// Sets the text of the last line.
  void show_message(std::string text) { message_ = std::move(text); }

  Command on_key(terminal::Key key);

  /// Lines of the screen: at most one per row, each at most as long as there are columns.
  std::vector<terminal::Row> lines(terminal::Size size);

private:
  static constexpr std::size_t table_begin = 2;  ///< rows above the table
  static constexpr std::size_t footer_rows = 2;

  /// Keeps the order of `before`, with new beacons last.
  void keep_rows(const std::vector<observation::BeaconView>& before);
  void sort_by(Order order);
  void move_by(std::ptrdiff_t rows);
  /// Index of the selected beacon; the first if none was selected or it is gone.
  [[nodiscard]] std::size_t selected_index() const;
  [[nodiscard]] std::size_t body_rows() const;
  [[nodiscard]] std::string title() const;
  std::vector<terminal::Row> table_lines();
  std::vector<terminal::Row> page_lines();
  [[nodiscard]] terminal::Row hint_line() const;

  std::vector<observation::BeaconView> views_;  ///< by row
  std::vector<std::string> warnings_;
  std::string message_;
  terminal::Size size_;
  Order order_ = Order::worst;
  std::optional<BeaconAddress> selected_;  ///< empty: the first row, whichever beacon it shows
  std::size_t first_row_ = 0;              ///< first visible row of the table
  std::optional<BeaconAddress> page_;      ///< beacon whose page is shown
  std::size_t page_row_ = 0;               ///< first visible line of the page
  bool shows_keys_ = false;
};

}  // namespace sonopose::monitor
