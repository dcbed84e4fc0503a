#include "bus_log/log_times.hpp"

#include "bus_log/summary.hpp"
#include "mcap/encoder.hpp"
#include "mcap/memory.hpp"
#include "mcap/writer.hpp"

#include <catch2/catch.hpp>

#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

namespace sonopose::bus_log::log_times_test {

using Catch::Contains;

constexpr std::uint64_t second = 1'000'000'000;

/// Describes a recording of one channel with a chunk for each pair of log times.
mcap::Bytes recording_of(std::initializer_list<std::pair<std::uint64_t, std::uint64_t>> chunks_s) {
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
  return sink.content;
}

std::optional<std::string> step_back_of(
    std::initializer_list<std::pair<std::uint64_t, std::uint64_t>> chunks_s) {
  return step_back_in(sonopose::test::reader_of(recording_of(chunks_s)));
}

std::optional<std::string> gap_of(std::initializer_list<std::pair<std::uint64_t, std::uint64_t>> chunks_s) {
  return longest_gap_in(sonopose::test::reader_of(recording_of(chunks_s)));
}

TEST_CASE("The longest time without a message is found, between chunks and within one") {
  CHECK_FALSE(gap_of({{100, 101}, {102, 106}, {106, 107}}));
  CHECK(gap_of({{100, 101}, {109, 110}, {120, 121}}) == "no messages for 10.0 s after 10.000 s");
  CHECK(gap_of({{100, 101}, {102, 162}}) == "no messages for 60.0 s after 2.000 s");
  CHECK(gap_of({{100, 101}, {90, 91}}) == "no messages for 9.0 s after 1.000 s");
}

TEST_CASE("A summary names the gap and a clock that was set back") {
  const auto content = recording_of({{100, 101}, {162, 163}, {102, 103}});
  const std::string text = summary_text(sonopose::test::reader_of(content));
  CHECK_THAT(text, Contains("gap       no messages for 59.0 s after 3.000 s\n") &&
                       Contains("clock     memory.mcap: the log times go back by 59.0 s"));
  const auto steady = recording_of({{100, 101}, {102, 103}});
  CHECK_THAT(summary_text(sonopose::test::reader_of(steady)), !Contains("gap ") && !Contains("clock "));
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

}  // namespace sonopose::bus_log::log_times_test
