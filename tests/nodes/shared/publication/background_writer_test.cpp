#include "publication/background_writer.hpp"

#include <catch2/catch.hpp>

#include <functional>
#include <future>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace background_writer_test {

using namespace sonopose;
using namespace sonopose::publication;
using Catch::Contains;

using Writer = BackgroundWriter<int>;
const Writer::Words words{"the list", "number"};

void push_up_to(int count, Writer& writer) {
  for (int i = 0; i < count; ++i) writer.push({&i, 1});
}

SCENARIO("everything is written in order, also if the queue is short and the writer slow") {
  GIVEN("a writer with a queue of 64 that lets its source wait") {
    std::vector<int> written;
    Writer writer(words, 64, FullQueuePolicy::wait, [&](std::span<const int> items) {
      written.insert(written.end(), items.begin(), items.end());
    });
    WHEN("ten times as much is pushed at once") {
      push_up_to(640, writer);
      writer.finish();
      THEN("nothing is lost") {
        std::vector<int> all(640);
        std::iota(all.begin(), all.end(), 0);
        CHECK(written == all);
        CHECK(writer.lost() == 0);
      }
    }
  }
}

SCENARIO("a disk that stands still loses what exceeds the queue, and does not delay the source") {
  GIVEN("a writer that waits for its disk") {
    std::promise<void> disk_continues;
    std::vector<int> written;
    Writer writer(words, 64, FullQueuePolicy::lose,
                  [&, wait = disk_continues.get_future().share()](auto items) {
                    wait.wait();
                    written.insert(written.end(), items.begin(), items.end());
                  });
    WHEN("more is pushed than fits") {
      push_up_to(100, writer);
      THEN("the rest is lost and counted, and the end reports it") {
        CHECK(writer.lost() == 36);
        disk_continues.set_value();
        CHECK_THROWS_WITH(writer.finish(), Contains("the list lacks 36 numbers"));
        CHECK(written.size() == 64);
      }
    }
  }
}

SCENARIO("a disk that stands still does not delay the end") {
  GIVEN("writers that wait for their disk without end") {
    std::promise<void> disk_continues;
    const auto wait_for_disk = [wait = disk_continues.get_future().share()](auto) { wait.wait(); };
    process::StopSignal stop;
    {
      Writer losing(words, 64, FullQueuePolicy::lose, wait_for_disk);
      Writer waiting(words, 64, FullQueuePolicy::wait, wait_for_disk);
      for (Writer* const writer : {&losing, &waiting}) {
        writer->obey(stop);
        push_up_to(40, *writer);
      }
      WHEN("the process is asked to stop, and there is more than fits") {
        const auto began = std::chrono::steady_clock::now();
        const auto took = [began] { return std::chrono::steady_clock::now() - began; };
        const auto end = [](Writer& writer) {
          push_up_to(30, writer);
          writer.finish();
        };
        stop.request();
        auto lost = std::async(std::launch::async, end, std::ref(losing));
        THEN("each ends after a second, and everything that the disk did not take is lost") {
          CHECK_THROWS_WITH(end(waiting), Contains("the list lacks 70 numbers"));
          CHECK(took() >= std::chrono::nanoseconds(Writer::max_delay_ns));
          CHECK_THROWS_WITH(lost.get(), Contains("the list lacks 70 numbers"));
        }
      }
    }
    disk_continues.set_value();
  }
}

SCENARIO("data that can wait is written to a slow disk to its end") {
  std::vector<int> written;
  {
    Writer writer(words, 8192, FullQueuePolicy::wait, [&written](std::span<const int> items) {
      std::this_thread::sleep_for(std::chrono::milliseconds(550));
      written.insert(written.end(), items.begin(), items.end());
    });
    push_up_to(8192, writer);
    writer.finish();
  }
  CHECK(written.size() == 8192);
}

SCENARIO("an error ends the writing and nothing else") {
  GIVEN("a writer whose disk is full after the first items") {
    for (const FullQueuePolicy when_full : {FullQueuePolicy::lose, FullQueuePolicy::wait}) {
      int calls = 0;
      Writer writer(words, 64, when_full, [&](std::span<const int>) {
        ++calls;
        throw std::runtime_error("No space left on device");
      });
      WHEN("more is pushed than fits, as mode " + std::to_string(static_cast<int>(when_full))) {
        push_up_to(1000, writer);
        THEN("the source is not delayed, all of it is counted, and the disk is left alone") {
          CHECK_THROWS_WITH(writer.finish(), Contains("lacks 1000 numbers"));
          CHECK(calls == 1);
        }
      }
    }
  }
}

}  // namespace background_writer_test
