#include "player/gaps.hpp"

#include "logging/captured_log.hpp"
#include "mcap/encoder.hpp"
#include "mcap/memory.hpp"
#include "mcap/writer.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace sonopose::player::test::gaps_test {

using Catch::Contains;

constexpr std::uint64_t second = 1'000'000'000;
constexpr std::uint64_t begin_ns = 1'600'000'000 * second;
constexpr std::uint64_t six_years = std::uint64_t{2190} * 86400 * second;

/// Plays messages at these times after the beginning. Returns the log.
std::string log_of(Gaps& gaps, std::initializer_list<std::uint64_t> after_ns) {
  logging::test::CapturedError error;
  gaps.begin(begin_ns);
  for (const std::uint64_t each : after_ns) gaps.advance_to(begin_ns + each);
  error.restore();
  return error.read();
}

SCENARIO("times without messages are named") {
  GIVEN("a player that shortens nothing") {
    Gaps gaps({}, 1.0, begin_ns);
    THEN("a step of the clock is named, with the option that shortens it") {
      CHECK_THAT(log_of(gaps, {12 * second / 10, six_years}),
                 Contains("no messages for 6.0 years after 1.200 s; --max-gap S shortens such gaps"));
      CHECK(gaps.shortened() == 0);
    }
    THEN("the periods of samples are not, and neither is a step back") {
      CHECK(log_of(gaps, {1 * second, 3 * second, 2 * second, 4 * second}).empty());
    }
  }
  GIVEN("a player that does not wait") {
    Gaps gaps({}, 0.0, begin_ns);
    CHECK(log_of(gaps, {six_years}).empty());
  }
  GIVEN("a recording with a gap after each message") {
    Gaps gaps({}, 1.0, begin_ns);
    std::string log;
    for (int i = 0; i < 100; ++i) log += log_of(gaps, {60 * second});
    THEN("the log has a limit, and says so") {
      CHECK(std::count(log.begin(), log.end(), '\n') == 21);
      CHECK_THAT(log, Contains("further gaps are not named"));
    }
  }
}

SCENARIO("times without messages are shortened") {
  GIVEN("a limit of half a second") {
    Gaps gaps(0.5, 1.0, begin_ns);
    gaps.begin(begin_ns);
    THEN("what exceeds it is left out, and counted") {
      CHECK(gaps.advance_to(begin_ns + second / 2) == 0);
      CHECK(gaps.advance_to(begin_ns + 2 * second) == second);
      CHECK(gaps.advance_to(begin_ns + second) == 0);  // a step back
      CHECK(gaps.advance_to(begin_ns + 2 * second + six_years) == six_years - second / 2);
      CHECK(gaps.shortened() == 2);
      CHECK(gaps.left_out_s() == Approx(static_cast<double>(six_years) * 1e-9 + 0.5));
    }
  }
  CHECK_THROWS_AS(Gaps(-1.0, 1.0, 0), std::invalid_argument);
  CHECK_THROWS_AS(Gaps(std::numeric_limits<double>::quiet_NaN(), 1.0, 0), std::invalid_argument);
}

/// Describes a recording of one channel with a chunk for each pair of log times.
std::optional<std::string> step_back_of(
    std::initializer_list<std::pair<std::uint64_t, std::uint64_t>> chunks_s) {
  sonopose::test::MemorySink sink;
  mcap::Writer writer(sink);
  const auto channel = writer.add_channel(0, "t", "json");
  for (const auto& [first_s, second_s] : chunks_s) {
    for (const std::uint64_t time_s : {first_s, second_s}) {
      writer.write({channel, 1, time_s * second, time_s * second, {}});
    }
    writer.end_chunk();
  }
  writer.close();
  return step_back_in(sonopose::test::reader_of(sink.content));
}

TEST_CASE("A clock that was set back during a recording is found") {
  CHECK_FALSE(step_back_of({{100, 101}, {101, 102}, {102, 103}}));
  CHECK_FALSE(step_back_of({{100, 102}, {101, 103}}));  // chunks may overlap
  CHECK_THAT(step_back_of({{100, 101}, {102, 3}, {4, 5}}).value_or(""),
             Contains("memory.mcap: the log times go back by 95.0 s"));
  CHECK_THAT(step_back_of({{100, 3}}).value_or(""), Contains("go back by 97.0 s"));
}

TEST_CASE("A clock that was set back is found in a file without chunks") {
  const auto step_back_of_plain = [](std::initializer_list<std::uint64_t> log_times_s) {
    mcap::Bytes file;
    mcap::put_bytes(file, std::as_bytes(std::span(mcap::magic)));
    mcap::put_record(file, mcap::Opcode::header, [&file] {
      for (int i = 0; i < 2; ++i) mcap::put_text(file, "");  // profile and library
    });
    mcap::put_record(file, mcap::Opcode::channel, [&file] {
      mcap::put(file, std::uint16_t{1});
      mcap::put(file, std::uint16_t{0});  // no schema
      for (const char* const text : {"t", "json"}) mcap::put_text(file, text);
      mcap::put_sized(file, [] {});
    });
    for (const std::uint64_t time_s : log_times_s) {
      mcap::put_record(file, mcap::Opcode::message, [&file, time_s] {
        mcap::put(file, std::uint16_t{1});
        mcap::put(file, std::uint32_t{0});
        for (int i = 0; i < 2; ++i) mcap::put(file, time_s * second);  // log time and publish time
      });
    }
    return step_back_in(sonopose::test::reader_of(file));
  };
  CHECK_FALSE(step_back_of_plain({100, 101, 102}));
  CHECK_THAT(step_back_of_plain({100, 101, 90, 91}).value_or(""), Contains("go back by 11.0 s"));
}

}  // namespace sonopose::player::test::gaps_test
