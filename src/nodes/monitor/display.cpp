#include "monitor/display.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include "monitor/counters_since.hpp"
#include "monitor/monitor_report.hpp"
#include "monitor/screen.hpp"
#include "observation/bus/views_json.hpp"
#include "process/emergency_cleanup.hpp"
#include "terminal/crash_restore.hpp"
#include "terminal/terminal.hpp"
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace sonopose::monitor {
namespace {

/// Throws std::system_error if the output cannot be written, as to a full disk: nobody sees this monitor.
void flush() {
  if (std::fflush(stdout) != 0) {
    throw std::system_error(errno, std::generic_category(), "the output cannot be written");
  }
}

class PrintedTable final : public Display {
public:
  void show(std::vector<observation::BeaconView> views, std::vector<std::string> warnings) override {
    fmt::print("{}", text::printable(table_of(views, warnings)));
    flush();
  }
};

class PrintedJson final : public Display {
public:
  void show(std::vector<observation::BeaconView> views, std::vector<std::string> warnings) override {
    fmt::print("{}\n", text::printable(observation::bus::json_of(views, warnings, clocks::host_now())));
    flush();
  }
};

/// Draws once a second, soon after a key, and at most twice a second for messages.
class FullScreen final : public Display {
public:
  FullScreen() { process::set_emergency_cleanup(terminal::CrashRestore::restore_now); }

  void show(std::vector<observation::BeaconView> views, std::vector<std::string> warnings) override {
    received_ = std::move(views);
    warnings_ = std::move(warnings);
    update();
  }

  bool poll() override {
    while (const auto key = terminal_.key()) {
      draw_after_ns_ = min_key_period_ns;
      switch (screen_.on_key(*key)) {
        case Command::none:
          break;
        case Command::quit:
          return true;
        case Command::clear_counters:
          counters_.clear(received_);
          update();
          break;
      }
    }
    for (std::string& line : terminal_.messages()) on_message(std::move(line));
    if (draw_after_ns_ && clocks::steady_now() - drawn_ >= *draw_after_ns_) draw();
    return false;
  }

private:
  static constexpr TimeNs min_key_period_ns = 50'000'000;
  static constexpr TimeNs min_message_period_ns = 500'000'000;

  void update() {
    std::vector<observation::BeaconView> views = received_;
    counters_.apply(views, seconds_between(start_, clocks::steady_now()));
    screen_.show(std::move(views), warnings_);
    draw_after_ns_ = min_key_period_ns;
  }

  void on_message(std::string line) {
    constexpr std::string_view prefix = "sonopose-monitor: ";
    if (line.starts_with(prefix)) line.erase(0, prefix.size());
    message_ = std::move(line);
    message_time_ = clocks::steady_now();
    draw_after_ns_ = draw_after_ns_.value_or(min_message_period_ns);
  }

  void draw() {
    const SteadyTime now = clocks::steady_now();
    if (!message_.empty()) {
      screen_.show_message(fmt::format("{:.0f} s ago: {}", seconds_between(message_time_, now), message_));
    }
    terminal_.draw(screen_.lines(terminal_.size()));
    drawn_ = now;
    draw_after_ns_.reset();
  }

  terminal::Terminal terminal_;
  Screen screen_;
  CountersSince counters_;
  SteadyTime start_ = clocks::steady_now();
  std::vector<observation::BeaconView> received_;
  std::vector<std::string> warnings_;
  std::string message_;
  SteadyTime message_time_{};
  SteadyTime drawn_{};
  std::optional<TimeNs> draw_after_ns_ = 0;  ///< time since the last drawing; empty: nothing has changed
};

}  // namespace

std::unique_ptr<Display> make_display(Output output) {
  switch (output) {
    case Output::table:
      return std::make_unique<PrintedTable>();
    case Output::json:
      return std::make_unique<PrintedJson>();
    case Output::screen:
      break;
  }
  try {
    return std::make_unique<FullScreen>();
  } catch (const terminal::NoScreen& error) {
    logging::warning(fmt::format("{}; tables instead of a screen", error.what()));
    return std::make_unique<PrintedTable>();
  }
}

}  // namespace sonopose::monitor
