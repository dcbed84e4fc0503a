/// The lines of other processes, as the page receives them.

#include "web/log_lines.hpp"

#include "support/test_domain.hpp"

#include <catch2/catch.hpp>

#include <chrono>
#include <thread>

namespace log_lines_test {

using namespace sonopose;
using web::HeldEvents;
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

LogLine line_of(const std::string& program, std::uint32_t process_id, TimeNs time_ns) {
  return {.host = "robot",
          .process_id = process_id,
          .time_ns = time_ns,
          .program = program,
          .text = program + " at " + std::to_string(time_ns)};
}

SCENARIO("the lines of two processes come by their time, and a process that ends is forgotten") {
  const test::TestDomain domain;
  const dds::DomainParticipant participant({.domain_id = domain.id()});
  const dds::qos::Provider qos;
  auto bridge = dds::topics::make_writer(participant, qos, dds::topics::log);
  auto fusion = dds::topics::make_writer(participant, qos, dds::topics::log);
  for (const TimeNs time_ns : {20, 40})
    bridge.write(dds::topics::to_idl(line_of("sonopose-bridge", 1, time_ns)));
  for (const TimeNs time_ns : {10, 30})
    fusion.write(dds::topics::to_idl(line_of("sonopose-fusion", 2, time_ns)));
  LogLines lines(participant, qos);
  CHECK_FALSE(lines.has("sonopose-fusion"));
  const std::vector<LogLine> taken = lines.take();  // within one process a reader has them at once
  REQUIRE(taken.size() == 4);
  CHECK(taken[0].text == "sonopose-fusion at 10");
  CHECK(taken[3].text == "sonopose-bridge at 40");
  CHECK(lines.has("sonopose-fusion"));
  CHECK(lines.has("sonopose-bridge"));
  WHEN("the fusion ends") {
    fusion = {};
    THEN("it has no log any more") {
      CHECK(wait_until([&] { return lines.take().empty() && !lines.has("sonopose-fusion"); }));
      CHECK(lines.has("sonopose-bridge"));
    }
  }
}

SCENARIO("events wait for two calls, and the latest are kept") {
  HeldEvents held;
  held.hold("a");
  CHECK(held.take_due().empty());
  held.hold("b");
  CHECK(held.take_due() == std::vector<std::string>{"a"});
  CHECK(held.take_due() == std::vector<std::string>{"b"});
  CHECK(held.take_due().empty());
  for (std::size_t i = 0; i <= HeldEvents::most; ++i) held.hold(std::to_string(i));
  held.take_due();
  const auto due = held.take_due();
  REQUIRE(due.size() == HeldEvents::most);
  CHECK(due.front() == "1");
  held.hold("c");
  held.clear();
  held.take_due();
  CHECK(held.take_due().empty());
}

}  // namespace log_lines_test
