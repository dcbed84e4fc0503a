#include "process/service.hpp"

#include "support/notify_socket.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <cstdlib>

namespace service_test {

using namespace sonopose;
using namespace sonopose::process;

// The process reads its environment once, so this is one scenario.
SCENARIO("the service manager learns that the program serves and goes on") {
  GIVEN("a manager whose watchdog has a period of 1 s") {
    const test::TemporaryFolder folder;
    test::NotifySocket manager(folder / "notify");
    ::setenv("NOTIFY_SOCKET", (folder / "notify").c_str(), 1);
    ::setenv("WATCHDOG_USEC", "1000000", 1);
    WHEN("the program reports twice that it serves, and progress at 5.000, 5.001 and 5.200 s") {
      report_ready();
      report_ready();
      report_status("waiting");
      const SteadyTime start{5'000'000'000};
      const SteadyTime next = report_progress_by(start);
      report_progress(start + 1'000'000);
      report_progress(start + 200'000'000);
      THEN("it is ready once, and its progress is passed on at most eight times in a period") {
        CHECK(manager.next(0) == "READY=1");
        CHECK(manager.next(0) == "STATUS=waiting");
        CHECK(manager.next(0) == "WATCHDOG=1");
        CHECK(manager.next(0) == "WATCHDOG=1");
        CHECK(manager.next(0).empty());
        CHECK(next - start == 250'000'000);
      }
    }
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
  }
}

SCENARIO("SIGUSR2 asks for the settings to be read again, once") {
  const ReloadRequest request;
  CHECK_FALSE(ReloadRequest::take());
  REQUIRE(::raise(SIGUSR2) == 0);
  CHECK(ReloadRequest::take());
  CHECK_FALSE(ReloadRequest::take());
}

}  // namespace service_test
