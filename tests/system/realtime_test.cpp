/// --realtime: programs report what is applied and what is refused, and run in both cases.

#include "support/bus.hpp"
#include "support/checked_run.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sched.h>

namespace sonopose::realtime_test {

using namespace sonopose::test;
using Catch::Contains;

/// Scheduling policy of a process's thread by name; −1 if there is no such thread.
int policy_of_thread(int pid, const std::string& name) {
  for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    std::ifstream comm(task.path() / "comm");
    std::string found;
    std::getline(comm, found);
    if (found == name) return ::sched_getscheduler(std::stoi(task.path().filename())) & ~SCHED_RESET_ON_FORK;
  }
  return -1;
}

bool is_about_recv(const std::string& line) {
  return line.find("thread recv:") != std::string::npos;
}

SCENARIO("a fusion with and without --realtime") {
  const Bus bus;
  GIVEN("--realtime") {
    const auto fusion = bus.fusion({"--realtime=31"});
    const auto lines = fusion->lines(Stream::error);
    THEN("it reports the scheduling of the receive thread correctly") {
      const auto said = std::find_if(lines.begin(), lines.end(), is_about_recv);
      REQUIRE(said != lines.end());
      CHECK_THAT(*said, Contains("sonopose-fusion: ") && Contains("realtime: ") && Contains("31"));
      const bool refused = said->find("not applied") != std::string::npos;
      if (refused) CHECK_THAT(*said, Contains("sched_setscheduler") && Contains("remedy"));
      CHECK(policy_of_thread(fusion->pid(), "recv") == (refused ? ::sched_getscheduler(0) : SCHED_FIFO));
    }
    THEN("poses are published") {
      const auto bridge = bus.bridge({"--realtime"});
      Consumer poses(bus, dds::topics::pose);
      CHECK(poses.wait_for_count(100));
      CHECK(bridge->wait_for_line(Stream::error, "realtime"));
    }
  }
  GIVEN("no option") {
    const auto fusion = bus.fusion();
    THEN("nothing is reported or changed") {
      CHECK_THAT(fusion->text(Stream::error), !Contains("realtime"));
      CHECK(policy_of_thread(fusion->pid(), "recv") == ::sched_getscheduler(0));
    }
  }
}

SCENARIO("an invalid priority is refused") {
  CHECK_THAT(refusal_of(SONOPOSE_TEST_FUSION, {"--realtime=100"}, neutral),
             Contains("--realtime") && Contains("100"));
}

}  // namespace sonopose::realtime_test
