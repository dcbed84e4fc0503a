#include "launch/together.hpp"

#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <string>

namespace together_test {

using namespace sonopose::launch;
using sonopose::test::read_text;
using sonopose::test::TemporaryFolder;

/// Gives a signal its default effect: nohup(1) and a shell's background jobs ignore some.
class DefaultSignal {
public:
  explicit DefaultSignal(int signal) : signal_(signal) {
    struct sigaction action {};
    action.sa_handler = SIG_DFL;
    REQUIRE(::sigaction(signal, &action, &before_) == 0);
  }
  DefaultSignal(const DefaultSignal&) = delete;
  DefaultSignal& operator=(const DefaultSignal&) = delete;
  ~DefaultSignal() { ::sigaction(signal_, &before_, nullptr); }

private:
  int signal_;
  struct sigaction before_ {};
};

/// A program that ends and reports it when asked to.
Program waiting(const TemporaryFolder& folder) {
  return {"sh",
          {"-c", "trap 'echo asked > " + (folder / "asked").string() + "; exit 0' TERM; touch " +
                     (folder / "waits").string() + "; while :; do sleep 0.02; done"}};
}

/// A program that runs `command` once the other one waits.
Program then(const TemporaryFolder& folder, const std::string& command) {
  return {"sh", {"-c", "until [ -e " + (folder / "waits").string() + " ]; do sleep 0.02; done; " + command}};
}

SCENARIO("the first program that ends ends the others") {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& command) {
    return run_together({waiting(folder), then(folder, command)}, ErrorOutput::pass_on);
  };
  WHEN("it succeeds") {
    CHECK(run("exit 0") == 0);
    CHECK(read_text(folder / "asked") == "asked\n");
  }
  WHEN("it fails") {
    CHECK(run("exit 5") == 5);
    CHECK(read_text(folder / "asked") == "asked\n");
  }
  WHEN("it is killed") {
    CHECK(run("kill -KILL $$") == 128 + 9);
    CHECK(read_text(folder / "asked") == "asked\n");
  }
  WHEN("it does not exist") {
    CHECK(run_together({waiting(folder), {"sonopose-absent", {}}}, ErrorOutput::pass_on) == 127);
  }
}

SCENARIO("a signal that asks this process to end ends the programs") {
  const TemporaryFolder folder;
  const auto [number, signal] =
      GENERATE(table<int, std::string>({{SIGINT, "INT"}, {SIGTERM, "TERM"}, {SIGHUP, "HUP"}}));
  const DefaultSignal default_signal(number);
  const Program asking = then(folder, "kill -" + signal + " $PPID; while :; do sleep 0.1; done");
  CHECK(run_together({waiting(folder), asking}, ErrorOutput::pass_on) == 0);
  CHECK(read_text(folder / "asked") == "asked\n");
}

SCENARIO("out of processor time, a group ends, and repetitions of the signal kill nothing") {
  const TemporaryFolder folder;
  const Program slow{
      "sh",
      {"-c", "trap 'sleep 2.5; echo asked > " + (folder / "asked").string() + "; exit 0' TERM; touch " +
                 (folder / "waits").string() + "; while :; do sleep 0.02; done"}};
  const Program limit = then(folder, "trap '' TERM; for i in 1 2 3; do kill -XCPU $PPID; sleep 0.6; done");
  CHECK(run_together({slow, limit}, ErrorOutput::pass_on) == 0);
  CHECK(read_text(folder / "asked") == "asked\n");
}

SCENARIO("a program that has the terminal can restore it before it is killed") {
  const DefaultSignal default_signal(SIGINT);
  // The third, if the second SIGTERM came less than a second after the first.
  const int restores_at = GENERATE(2, 3);
  GIVEN("one that restores the terminal at a later SIGTERM, next to one that ignores the first") {
    WHEN("Ctrl-C is pressed, and again after more than a second") {
      bool is_restored = false;
      int code = 0;
      for (int i = 0; i < 5 && !is_restored; ++i) {  // on a busy machine a second may be too short for it
        const TemporaryFolder folder;
        const Program screen{
            "sh",
            {"-c", "trap 'n=$((n + 1)); [ $n -lt " + std::to_string(restores_at) + " ] || { echo yes > " +
                       (folder / "restored").string() + "; exit 0; }' TERM; touch " +
                       (folder / "waits").string() + "; while :; do sleep 0.02; done"},
            true};
        const Program other = then(folder,
                                   "trap '' TERM; kill -INT $PPID; sleep 1.1; "
                                   "while :; do kill -INT $PPID; sleep 0.2; done");  // the first may be late
        code = run_together({screen, other}, ErrorOutput::pass_on);
        is_restored = exists(folder / "restored");
      }
      THEN("it has restored the terminal, and the other one was killed") {
        CHECK(is_restored);
        CHECK(code == 128 + 9);
      }
    }
  }
}

}  // namespace together_test
