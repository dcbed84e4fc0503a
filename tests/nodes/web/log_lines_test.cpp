/// Log lines of other processes as the page receives them.

#include "web/log_lines.hpp"

#include "support/test_domain.hpp"
#include "support/wait_until.hpp"
#include "web/live/missing_lines.hpp"

#include <catch2/catch.hpp>

namespace sonopose::log_lines_test {

using test::wait_until;
using web::LogLines;

LogLine line_of(const std::string& program, std::uint32_t process_id, std::uint64_t number, TimeNs time_ns) {
  return {.host = "robot",
          .process_id = process_id,
          .number = number,
          .time_ns = time_ns,
          .program = program,
          .text = program + " at " + std::to_string(time_ns)};
}

SCENARIO("the lines of two processes come by their time, with the number of those that are missing") {
  const test::TestDomain domain;
  const auto participant = dds::ext::participant({.domain_id = domain.id()});
  const dds::qos::Provider qos;
  auto bridge = dds::topics::make_writer(participant, qos, dds::topics::log);
  auto fusion = dds::topics::make_writer(participant, qos, dds::topics::log);
  const auto write = [](auto& writer, const LogLine& line) { writer.write(dds::topics::to_idl(line)); };
  write(bridge, line_of("sonopose-bridge", 1, 1, 20));
  write(bridge, line_of("sonopose-bridge", 1, 4, 40));
  write(fusion, line_of("sonopose-fusion", 2, 38, 10));
  write(fusion, line_of("sonopose-fusion", 2, 39, 30));
  LogLines lines(participant, qos);
  const auto taken = lines.take();  // within one process a reader has them immediately
  REQUIRE(taken.size() == 4);
  CHECK(taken[0].line.text == "sonopose-fusion at 10");
  CHECK(taken[0].missing == 37);
  CHECK(taken[1].missing == 0);
  CHECK(taken[2].missing == 0);
  CHECK(taken[3].line.text == "sonopose-bridge at 40");
  CHECK(taken[3].missing == 2);
  WHEN("a process logs twice and ends, and another one gets its id") {
    write(fusion, line_of("sonopose-fusion", 2, 40, 50));
    write(fusion, line_of("sonopose-fusion", 2, 41, 60));
    fusion = dds::core::null;
    auto ended = lines.take();
    REQUIRE(ended.size() == 2);
    CHECK(ended[0].missing == 0);
    CHECK(ended[1].missing == 0);
    fusion = dds::topics::make_writer(participant, qos, dds::topics::log);
    write(fusion, line_of("sonopose-fusion", 2, 3, 70));
    std::vector<LogLines::Received> later;
    REQUIRE(wait_until([&] {
      later = lines.take();
      return !later.empty();
    }));
    THEN("the lines of the other one are counted from the beginning") {
      CHECK(later[0].missing == 2);
    }
  }
}

TEST_CASE("the numbers of a process that restarts are counted from the beginning") {
  web::live::MissingLines missing;
  const auto before = [&missing](std::uint64_t number) { return missing.before(line_of("x", 1, number, 0)); };
  CHECK(before(50) == 49);
  CHECK(before(51) == 0);
  CHECK(before(1) == 0);
  CHECK(before(4) == 2);
  CHECK(before(0) == 0);  // unnumbered
  CHECK(before(UINT64_MAX) == UINT64_MAX - 1);
}

}  // namespace sonopose::log_lines_test
