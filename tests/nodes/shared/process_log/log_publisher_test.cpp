/// The process's log on the bus.

#include "process_log/log_publisher.hpp"

#include "process/host_name.hpp"
#include "support/test_domain.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

#include <chrono>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sonopose::log_publisher_test {

/// Lines that a late-joining process receives.
class LogReader {
public:
  explicit LogReader(std::uint32_t domain_id)
      : participant_(dds::ext::participant({.domain_id = domain_id})),
        reader_(dds::topics::make_reader(participant_, dds::qos::Provider(), dds::topics::log)) {}

  std::vector<LogLine> wait_for(std::size_t count) {
    std::vector<LogLine> lines;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(3);
    while (lines.size() < count && std::chrono::steady_clock::now() < give_up) {
      dds::ext::try_take_each(reader_, [&](const sonopose_LogLine& sample, const dds::sub::SampleInfo&) {
        lines.push_back(dds::topics::from_idl(sample));
      });
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return lines;
  }

private:
  dds::domain::DomainParticipant participant_;
  dds::sub::DataReader<sonopose_LogLine> reader_;
};

SCENARIO("a process publishes its log, also for readers that come later") {
  const test::TestDomain domain;
  const auto participant = dds::ext::participant({.domain_id = domain.id()});
  logging::set_program("sonopose-x");
  const logging::Session session(logging::Level::debug, logging::Session::default_capacity,
                                 logging::Session::Repetition::unlimited);
  logging::info("before the bus");
  const process_log::LogPublisher publisher(participant, dds::qos::Provider());
  logging::debug("only on standard error");
  logging::warning("a warning");
  logging::failure(std::string(2000, 'y'));  // returns after the line is written
  WHEN("a reader appears") {
    const auto lines = LogReader(domain.id()).wait_for(3);
    REQUIRE(lines.size() == 3);
    THEN("it receives the lines with their process, without those of level debug") {
      CHECK(lines[0].text == "before the bus");
      CHECK(lines[0].level == LogLevel::info);
      CHECK(lines[1].text == "a warning");
      CHECK(lines[1].level == LogLevel::warning);
      CHECK(lines[2].level == LogLevel::failure);
      for (const LogLine& line : lines) {
        CHECK(line.program == "sonopose-x");
        CHECK(line.host == process::host_name());
        CHECK(line.process_id == static_cast<std::uint32_t>(::getpid()));
        CHECK(line.time_ns >= lines[0].time_ns);
        CHECK(line.number == 1 + static_cast<std::uint64_t>(&line - lines.data()));
      }
    }
    THEN("a text that is too long is cut, and says so") {
      CHECK(lines[2].text == std::string(1021, 'y') + "...");
    }
  }
  WHEN("more lines are logged than are kept") {
    for (int i = 0; i < 100; ++i) logging::info("line " + std::to_string(i));
    logging::failure("the end");
    THEN("a late reader receives the latest 64") {
      const auto lines = LogReader(domain.id()).wait_for(64);
      REQUIRE(lines.size() == 64);
      CHECK(lines.front().text == "line 37");
      CHECK(lines.front().number == 3 + 38);
      CHECK(lines.back().text == "the end");
    }
  }
}

}  // namespace sonopose::log_publisher_test
