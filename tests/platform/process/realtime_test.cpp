#include "process/realtime.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <map>
#include <unistd.h>

namespace realtime_test {

using namespace sonopose::process;
using Catch::Contains;

/// A machine whose answers a test chooses; it records the calls.
struct Machine {
  std::vector<NamedThread> threads{{100, "sonopose-fusion"}, {103, "gc"}, {105, "tev"}, {106, "recv"}};
  int fifo_error = 0;
  int memory_error = 0;
  int device_error = 0;
  bool unlimited = true;
  std::map<int, int> priorities;  ///< by thread id
  std::vector<bool> locks;        ///< one per mlockall: true if later memory is included
  int awake_file = -1;

  RealtimeCalls calls() {
    RealtimeCalls calls;
    calls.threads = [this] { return threads; };
    calls.set_fifo = [this](int thread, int priority) {
      if (fifo_error == 0) priorities[thread] = priority;
      return fifo_error;
    };
    calls.lock_memory = [this](bool future_too) {
      locks.push_back(future_too);
      return memory_error;
    };
    calls.may_lock_everything = [this] { return unlimited; };
    calls.hold_awake = [this](const char* /*device*/, sonopose::files::Descriptor& file) {
      if (device_error == 0) file = sonopose::files::Descriptor(::open("/dev/null", O_WRONLY | O_CLOEXEC));
      awake_file = file.number();
      return device_error;
    };
    return calls;
  }
};

bool is_open(int file) {
  return ::fcntl(file, F_GETFD) >= 0;
}

/// The only line that contains `text`.
std::string line_with(const std::vector<std::string>& lines, const std::string& text) {
  const auto has = [&text](const std::string& line) { return line.find(text) != std::string::npos; };
  REQUIRE(std::count_if(lines.begin(), lines.end(), has) == 1);
  return *std::find_if(lines.begin(), lines.end(), has);
}

SCENARIO("real time where everything is allowed") {
  GIVEN("a machine that refuses nothing") {
    Machine machine;
    machine.threads.push_back({107, backlog_thread_name});
    const Realtime realtime = apply_realtime(42, machine.calls());
    THEN("the threads on the path of a pose have the priority, and no others") {
      const int calling_thread = 0;
      CHECK(machine.priorities == std::map<int, int>{{calling_thread, 42}, {105, 42}, {106, 42}, {107, 42}});
    }
    THEN("every setting is reported, and none was refused") {
      CHECK(realtime.refused().empty());
      CHECK_THAT(line_with(realtime.applied(), "recv"), Contains("SCHED_FIFO") && Contains("42"));
      line_with(realtime.applied(), "tev");
      line_with(realtime.applied(), "main thread");
      line_with(realtime.applied(), "memory");
      line_with(realtime.applied(), "cpu_dma_latency");
    }
    THEN("future memory is locked too") {
      CHECK(machine.locks == std::vector<bool>{true});
    }
  }
  GIVEN("the object that keeps the settings") {
    Machine machine;
    int file = -1;
    {
      Realtime first = apply_realtime(50, machine.calls());
      file = machine.awake_file;
      const Realtime moved = std::move(first);
      THEN("the cores stay awake as long as it lives, wherever it is moved") {
        CHECK(is_open(file));
      }
    }
    CHECK_FALSE(is_open(file));
  }
}

SCENARIO("real time where something is refused") {
  Machine machine;
  WHEN("priorities are refused") {
    machine.fifo_error = EPERM;
    const Realtime realtime = apply_realtime(60, machine.calls());
    THEN("call, cause and remedy are reported, and the rest takes effect") {
      const std::string said = line_with(realtime.refused(), "thread recv");
      CHECK_THAT(said, Contains("sched_setscheduler") && Contains("60"));
      CHECK_THAT(said, Contains("Operation not permitted"));
      CHECK_THAT(said, Contains("CAP_SYS_NICE") && Contains("rtprio 60"));
      line_with(realtime.applied(), "memory");
      line_with(realtime.applied(), "cpu_dma_latency");
    }
  }
  WHEN("memory cannot be locked") {
    machine.memory_error = ENOMEM;
    const Realtime realtime = apply_realtime(50, machine.calls());
    THEN("call, cause and remedy are reported, and the rest takes effect") {
      CHECK_THAT(line_with(realtime.refused(), "mlockall"),
                 Contains("Cannot allocate memory") && Contains("CAP_IPC_LOCK") && Contains("memlock"));
      CHECK(machine.priorities.size() == 3);
    }
  }
  WHEN("there is a limit to locked memory") {
    machine.unlimited = false;
    const Realtime realtime = apply_realtime(50, machine.calls());
    THEN("future memory is not locked, so that allocations cannot fail, and that is reported") {
      CHECK(machine.locks == std::vector<bool>{false});
      CHECK_THAT(line_with(realtime.refused(), "future memory"),
                 Contains("RLIMIT_MEMLOCK") && Contains("memlock"));
    }
  }
  WHEN("the device of the cores' sleep is not ours") {
    machine.device_error = EACCES;
    const Realtime realtime = apply_realtime(50, machine.calls());
    THEN("device, cause and remedy are reported") {
      CHECK_THAT(line_with(realtime.refused(), "/dev/cpu_dma_latency"),
                 Contains("Permission denied") && Contains("udev"));
    }
  }
  WHEN("the node does not exist yet") {
    machine.threads = {{100, "sonopose-fusion"}};
    const Realtime realtime = apply_realtime(50, machine.calls());
    THEN("the missing threads are named") {
      CHECK_THAT(line_with(realtime.refused(), "recv"), Contains("after the node was created"));
      line_with(realtime.refused(), "tev");
    }
  }
  WHEN("the priority is out of range") {
    THEN("it is refused with the limits before anything is changed") {
      for (const int priority : {0, 100}) {
        CHECK_THROWS_WITH(apply_realtime(priority, machine.calls()),
                          Contains(std::to_string(priority)) && Contains("1 to 99"));
      }
      CHECK(machine.priorities.empty());
      CHECK(machine.locks.empty());
    }
  }
}

TEST_CASE("Linux names the threads of this process") {
  const auto threads = linux_calls().threads();
  CHECK(std::any_of(threads.begin(), threads.end(),
                    [](const NamedThread& thread) { return thread.id == ::getpid(); }));
}

}  // namespace realtime_test
