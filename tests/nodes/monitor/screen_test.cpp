#include "monitor/screen.hpp"

#include "monitor/screen_page.hpp"
#include "monitor/screen_table.hpp"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <limits>
#include <string>
#include <vector>

namespace screen_test {

using namespace sonopose;
using namespace sonopose::monitor;
using Catch::Contains;
using observation::BeaconView;
using terminal::Key;
using terminal::Row;
using terminal::Size;

constexpr TimeNs now_ns = 1'700'000'000'123'456'789;

/// A beacon with a good pose at x = its address in metres.
BeaconView good_view(BeaconAddress address) {
  BeaconView view;
  view.address = address;
  view.poses = 100;
  view.pose_rate_hz = 100.0;
  view.latency = {0.00012, 0.00034};
  view.pose.time_ns = now_ns;
  view.pose.position_world_m = {static_cast<double>(address), -2.25, 0.75};
  view.pose.trust = 0.93;
  view.bridge.emplace();
  view.bridge->battery_v = 3.9;
  view.bridge->imu_rate_hz = 99.5;
  view.bridge->fix_rate_hz = 12.0;
  view.fusion.emplace();
  view.fusions = {*view.fusion};
  view.segments.fill({0.001, 0.002});
  view.report.emplace();
  view.report->innovation_world_m = {0.0123, -0.0456, 0.0789};
  view.report->flags = fix_used;
  return view;
}

/// A beacon with a known address and no data.
BeaconView silent_view(BeaconAddress address) {
  BeaconView view;
  view.address = address;
  view.latency = observation::percentiles_of({});
  view.segments.fill(observation::percentiles_of({}));
  view.pose.since_valid_fix_s = std::numeric_limits<double>::infinity();
  return view;
}

Covariance<6> with_variance(double variance) {
  return Covariance<6>::from_matrix(variance * Covariance<6>::Matrix::Identity());
}

std::vector<BeaconView> good_views(BeaconAddress count) {
  std::vector<BeaconView> views;
  for (BeaconAddress address = 1; address <= count; ++address) views.push_back(good_view(address));
  return views;
}

std::string text_of(const Row& line) {
  std::string text;
  for (const terminal::Span& span : line) text += span.text;
  return text;
}

std::vector<std::string> texts_of(const std::vector<Row>& lines) {
  std::vector<std::string> texts;
  for (const Row& line : lines) texts.push_back(text_of(line));
  return texts;
}

std::string joined(const std::vector<Row>& lines) {
  std::string text;
  for (const Row& line : lines) text += text_of(line) + "\n";
  return text;
}

/// Addresses in the table's rows, from top to bottom.
std::vector<int> addresses_on(Screen& screen, Size size) {
  const auto lines = texts_of(screen.lines(size));
  std::vector<int> addresses;
  for (std::size_t row = 2; row + 2 < lines.size() && !lines[row].empty(); ++row) {
    addresses.push_back(std::stoi(lines[row].substr(0, 6)));
  }
  return addresses;
}

SCENARIO("the screen fits the terminal") {
  const auto size =
      GENERATE(Size{80, 24}, Size{100, 30}, Size{200, 60}, Size{40, 10}, Size{3, 2}, Size{1, 1});
  const auto count = GENERATE(BeaconAddress{0}, BeaconAddress{5}, BeaconAddress{250});
  CAPTURE(size.columns, size.rows, count);
  GIVEN("a screen with long warnings and messages") {
    Screen screen;
    auto views = good_views(count);
    views.push_back(silent_view(60'000));
    views.front().pose.status = 0xFFF;
    views.front().pose.position_world_m = {-123456789.0, 1e300, std::numeric_limits<double>::quiet_NaN()};
    screen.show(views, {std::string(300, 'w'), "another"});
    screen.show_message(std::string(300, 'm') + "\n\x1b[2J");
    const auto fits = [&] {
      const auto lines = texts_of(screen.lines(size));
      CHECK(lines.size() == size.rows);
      for (const std::string& line : lines) {
        CAPTURE(line);
        CHECK(columns_of(line) <= size.columns);
        CHECK(line.find_first_of("\n\x1b") == std::string::npos);
      }
    };
    THEN("no line is longer than the width, and there are as many as rows: table, keys and page") {
      fits();
      screen.on_key(Key{'?'});
      fits();
      screen.on_key(Key::enter);
      fits();
      screen.on_key(Key::end);
      fits();
    }
  }
}

SCENARIO("the table fills the rows between the title and the message") {
  const auto size = GENERATE(Size{80, 24}, Size{100, 30}, Size{200, 60});
  const auto count = GENERATE(BeaconAddress{5}, BeaconAddress{250});
  GIVEN("good beacons") {
    Screen screen;
    screen.show(good_views(count), {});
    THEN("each has a row, as far as there are rows") {
      CHECK(addresses_on(screen, size).size() == std::min<std::size_t>(count, size.rows - 4));
      const auto lines = texts_of(screen.lines(size));
      CHECK_THAT(lines[0],
                 Contains(fmt::format("{} beacons by worst", count)) && Contains("0 bad, 0 warned"));
      CHECK_THAT(lines[1], Contains("beacon") && Contains("status"));
      CHECK_THAT(lines[2], Contains("100.0") && Contains("12.0") && Contains("1.00") && Contains("0.93") &&
                               Contains("0.34") && Contains("ok"));
    }
    THEN("a message and a warning change the last two lines alone") {
      const auto before = texts_of(screen.lines(size));
      screen.show_message("beacon 3: no pose for 0.120 s");
      screen.show(good_views(count), {"line /dev/ttyACM0: no bytes"});
      const auto after = texts_of(screen.lines(size));
      CHECK(std::vector(before.begin(), before.end() - 2) == std::vector(after.begin(), after.end() - 2));
      CHECK(after.back() == "beacon 3: no pose for 0.120 s");
      CHECK(after[size.rows - 2] == "warning: line /dev/ttyACM0: no bytes");
    }
  }
  GIVEN("a warning that is longer than a line") {
    const std::string warning = "line /dev/ttyACM0: " + std::string(100, 'x') + " lastword";
    Screen screen;
    WHEN("there are beacons") {
      screen.show(good_views(3), {warning});
      const auto hint = texts_of(screen.lines(size))[size.rows - 2];
      THEN("it is cut with a sign, and the page of a beacon has all of it") {
        if (size.columns < warning.size()) CHECK_THAT(hint, Contains("…") && Catch::EndsWith("(all: Enter)"));
        screen.on_key(Key::enter);
        screen.on_key(Key::end);
        CHECK_THAT(joined(screen.lines(size)), Contains("lastword"));
      }
    }
    WHEN("there is no beacon, and so no page") {
      screen.show({}, {warning});
      THEN("the screen has all of it") {
        CHECK_THAT(joined(screen.lines(size)), Contains("lastword"));
      }
    }
  }
  GIVEN("a wider terminal") {
    THEN("it has more columns") {
      CHECK_THAT(text_of(table_heading(80)), !Contains("z m"));
      CHECK_THAT(text_of(table_heading(100)), Contains("z m"));
      CHECK_THAT(text_of(table_heading(200)),
                 Contains("z m") && Contains("battery V") && Contains("fix age s"));
    }
  }
}

SCENARIO("what is unknown is a dash") {
  GIVEN("a beacon of which only the address is known") {
    const std::string row = text_of(table_row(silent_view(21), 200, false));
    const std::string page = joined(page_of(silent_view(21), {}, 80));
    THEN("its row and its page contain no invented number") {
      CHECK_THAT(row, Contains("21") && Contains("–") && Contains("silent"));
      for (const std::string& text : {row, page}) {
        CHECK_THAT(text, !Contains("nan") && !Contains("inf") && !Contains("0.00"));
      }
      CHECK_THAT(page, Contains("battery V         –") && Contains("trust             –") &&
                           Contains("valid fix         – s ago"));
    }
  }
}

SCENARIO("the page of a beacon has what the table has no columns for") {
  GIVEN("a beacon in doubt, with an estimate") {
    BeaconView view = good_view(7);
    view.pose.status = status_low_trust | status_converging;
    view.report->flags = fix_outlier;
    view.report->test_ratio = 4.5;
    view.estimate.emplace();
    view.estimate->lever_arm_body_m = {Vector3d(0.1, 0.02, -0.5), Vector3d::Constant(0.003)};
    const std::string page = joined(page_of(view, {}, 80));
    THEN("trust, flags, innovation, battery, latency by segment and estimates are shown") {
      CHECK_THAT(page, Contains("trust             0.93") && Contains("converging, low trust"));
      CHECK_THAT(page, Contains("innovation m          0.012   -0.046    0.079"));
      CHECK_THAT(page, Contains("outlier; test ratio 4.50"));
      CHECK_THAT(page, Contains("battery V         3.90"));
      CHECK_THAT(page, Contains("bridge to fusion       1.00     2.00"));
      CHECK_THAT(page, Contains("lever arm") && Contains("0.1000±0.0030"));
    }
  }
}

SCENARIO("a long warning is wrapped on the page of a beacon") {
  GIVEN("a warning of 200 letters") {
    std::string warning;
    for (int i = 0; i < 40; ++i) warning += fmt::format("w{:03} ", i);
    const std::vector<Row> lines = page_of(silent_view(21), {warning}, 60);
    THEN("all of it is there, and no line is too long") {
      const std::string page = joined(lines);
      for (int i = 0; i < 40; ++i) CHECK_THAT(page, Contains(fmt::format("w{:03}", i)));
      for (const Row& line : lines) CHECK(columns_of(text_of(line)) <= 60);
    }
  }
}

SCENARIO("keys sort, scroll and open") {
  const Size size{80, 24};
  GIVEN("50 beacons, of which one is stale, one inaccurate, one doubted, and one late") {
    auto views = good_views(50);
    for (BeaconView& view : views) {
      view.pose.pose_covariance = with_variance(0.0001);
    }
    views[9].pose.status = status_stale;
    views[19].pose.pose_covariance = with_variance(1.0);
    views[29].pose.trust = 0.1;
    views[39].latency.p99_s = 0.5;
    Screen screen;
    screen.show(views, {});
    THEN("the worst is first without any key") {
      CHECK(addresses_on(screen, size).front() == 10);
      CHECK_THAT(text_of(screen.lines(size)[0]), Contains("1 bad") && Contains("by worst"));
    }
    THEN("each sorting key has its order, and keeps it when new values come") {
      for (const auto& [key, first] : {std::pair{'a', 1}, {'e', 20}, {'t', 30}, {'l', 40}, {'w', 10}}) {
        CAPTURE(key);
        CHECK(screen.on_key(Key{key}) == Command::none);
        CHECK(addresses_on(screen, size).front() == first);
        screen.show(views, {});
        CHECK(addresses_on(screen, size).front() == first);
      }
    }
    THEN("the table scrolls to the end and back") {
      screen.on_key(Key{'a'});
      screen.lines(size);
      screen.on_key(Key::end);
      CHECK(addresses_on(screen, size).back() == 50);
      CHECK(addresses_on(screen, size).size() == 20);
      screen.on_key(Key::page_up);
      CHECK(addresses_on(screen, size).front() == 31);
      screen.on_key(Key::page_up);
      CHECK(addresses_on(screen, size).front() == 12);
      screen.on_key(Key::home);
      CHECK(addresses_on(screen, size).front() == 1);
      for (int i = 0; i < 20; ++i) screen.on_key(Key::down);
      CHECK(addresses_on(screen, size).front() == 2);
      CHECK(addresses_on(screen, size).back() == 21);
    }
    THEN("rows stay while one is selected, also if values change and beacons come and go; home sorts again") {
      screen.lines(size);
      for (int i = 0; i < 2; ++i) screen.on_key(Key::page_down);
      const auto before = addresses_on(screen, size);
      CHECK(before.front() > 10);
      for (BeaconView& view : views) view.pose.pose_covariance = with_variance(1.0 / view.address);
      views.erase(views.begin());           // address 1, above the visible rows
      views.push_back(good_views(51)[50]);  // address 51
      screen.show(views, {});
      const auto after = addresses_on(screen, size);
      CHECK(std::search(after.begin(), after.end(), before.begin() + 1, before.end()) != after.end());
      CHECK_THAT(text_of(screen.lines(size)[0]), Contains("held until Home"));
      screen.on_key(Key::end);
      CHECK(addresses_on(screen, size).back() == 51);
      views.pop_back();  // the selected beacon
      screen.show(views, {});
      CHECK(addresses_on(screen, size).back() == 50);
      screen.on_key(Key::home);
      CHECK(addresses_on(screen, size).front() == 10);
      CHECK(addresses_on(screen, size)[1] == 2);
    }
    THEN("enter opens the selected beacon, also after it has moved; escape and enter close it") {
      screen.on_key(Key{'a'});
      screen.on_key(Key::down);
      screen.on_key(Key::down);
      views[2].pose.status = status_stale;  // address 3
      screen.show(views, {});
      screen.on_key(Key{'w'});
      screen.on_key(Key::enter);
      CHECK_THAT(text_of(screen.lines(size)[0]), Contains("beacon 3 "));
      screen.on_key(Key::escape);
      CHECK_THAT(text_of(screen.lines(size)[0]), Contains("50 beacons"));
      screen.on_key(Key::enter);
      screen.on_key(Key::enter);
      CHECK_THAT(text_of(screen.lines(size)[0]), Contains("50 beacons"));
    }
    THEN("a page scrolls, and says when its beacon is gone") {
      screen.on_key(Key::enter);
      const std::string top = joined(screen.lines(size));
      screen.on_key(Key::end);
      CHECK_THAT(joined(screen.lines(size)), Contains("Problems since"));
      screen.on_key(Key::home);
      CHECK(joined(screen.lines(size)) == top);
      screen.show({}, {});
      CHECK_THAT(joined(screen.lines(size)), Contains("the beacon is gone"));
    }
    THEN("? shows the keys; c and q are for the program") {
      screen.on_key(Key{'?'});
      CHECK_THAT(text_of(screen.lines(size)[22]), Contains("w worst") && Contains("c clear"));
      screen.on_key(Key{'?'});
      CHECK_THAT(text_of(screen.lines(size)[22]), !Contains("w worst"));
      CHECK(screen.on_key(Key{'c'}) == Command::clear_counters);
      CHECK(screen.on_key(Key{'q'}) == Command::quit);
    }
    THEN("the selected row stays visible on a smaller terminal") {
      screen.on_key(Key{'a'});
      for (int i = 0; i < 15; ++i) screen.on_key(Key::down);
      CHECK(addresses_on(screen, {80, 10}).back() == 16);
    }
  }
}

}  // namespace screen_test
