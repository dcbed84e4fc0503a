/// The lines of other processes, as the page receives them.

#include "web/log_lines.hpp"

#include "support/test_domain.hpp"

#include <catch2/catch.hpp>

#include <chrono>
#include <thread>

namespace log_lines_test {

using namespace sonopose;
using web::LogLines;

template <class Done>
bool wait_until(const Done& done) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

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
  const dds::DomainParticipant participant({.domain_id = domain.id()});
  const dds::qos::Provider qos;
  auto bridge = dds::topics::make_writer(participant, qos, dds::topics::log);
  auto fusion = dds::topics::make_writer(participant, qos, dds::topics::log);
  const auto write = [](auto& writer, const LogLine& line) { writer.write(dds::topics::to_idl(line)); };
  write(bridge, line_of("sonopose-bridge", 1, 1, 20));
  write(bridge, line_of("sonopose-bridge", 1, 4, 40));
  write(fusion, line_of("sonopose-fusion", 2, 38, 10));
  write(fusion, line_of("sonopose-fusion", 2, 39, 30));
  LogLines lines(participant, qos);
  const auto taken = lines.take();  // within one process a reader has them at once
  REQUIRE(taken.size() == 4);
  CHECK(taken[0].line.text == "sonopose-fusion at 10");
  CHECK(taken[0].missing == 37);
  CHECK(taken[1].missing == 0);
  CHECK(taken[2].missing == 0);
  CHECK(taken[3].line.text == "sonopose-bridge at 40");
  CHECK(taken[3].missing == 2);
  WHEN("another process has the host and the number of one that ended") {
    fusion = {};
    fusion = dds::topics::make_writer(participant, qos, dds::topics::log);
    REQUIRE(wait_until([&] { return lines.take().empty(); }));
    write(fusion, line_of("sonopose-fusion", 2, 3, 50));
    std::vector<LogLines::Received> later;
    REQUIRE(wait_until([&] {
      later = lines.take();
      return !later.empty();
    }));
    THEN("its lines are counted from the beginning") {
      CHECK(later[0].missing == 2);
    }
  }
}

}  // namespace log_lines_test
