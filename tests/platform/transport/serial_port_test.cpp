/// The serial line on pseudo-terminals, which the kernel treats like real ones.

#include "transport/serial_port.hpp"

#include "clocks/clocks.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include "transport/device_access.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <poll.h>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace serial_port_test {

using namespace sonopose;
using namespace sonopose::transport;
using namespace sonopose::files;
using namespace std::chrono_literals;
using Catch::Contains;
using sonopose::test::TemporaryFolder;
using sonopose::test::write_text;

/// The beacon's end of a line; its destruction unplugs the beacon.
class Beacon {
public:
  Beacon() : descriptor_{::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)} {
    REQUIRE(descriptor_ >= 0);
    REQUIRE(::grantpt(descriptor_) == 0);
    REQUIRE(::unlockpt(descriptor_) == 0);
    std::array<char, 128> name{};
    REQUIRE(::ptsname_r(descriptor_, name.data(), name.size()) == 0);
    device_ = name.data();
  }
  ~Beacon() { ::close(descriptor_); }
  Beacon(const Beacon&) = delete;
  Beacon& operator=(const Beacon&) = delete;

  [[nodiscard]] const std::string& device() const { return device_; }
  void send(const std::string& bytes) const {
    REQUIRE(::write(descriptor_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  /// Returns true if the host's end has sent anything back, as a line in echo mode does.
  [[nodiscard]] bool got_an_echo() const {
    pollfd poll{descriptor_, POLLIN, 0};
    return ::poll(&poll, 1, 50) > 0 && (poll.revents & POLLIN) != 0;
  }

  /// Reads what has arrived.
  [[nodiscard]] std::string received() const {
    if (!got_an_echo()) return {};
    std::string text(4096, '\0');
    const auto size = ::read(descriptor_, text.data(), text.size());
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
  }

private:
  int descriptor_;
  std::string device_;
};

/// The host's end with its buffer. It waits for results instead of a fixed time.
struct Host {
  std::unique_ptr<ByteLink> port;
  std::array<std::uint8_t, 4096> buffer{};

  /// Reads until the result is not a timeout.
  ReadResult next() {
    for (int i = 0; i < 1800; ++i) {
      const ReadResult result = port->read(buffer, 100ms);
      if (result.status != ReadStatus::timeout) return result;
    }
    return {};
  }
  /// Reads until there are this many bytes.
  std::string bytes(std::size_t count) {
    std::string text;
    while (text.size() < count) {
      const ReadResult result = next();
      if (result.status != ReadStatus::data) break;
      text.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(result.size));
    }
    return text;
  }
};

/// Another process that has a line open and does not read it.
class Sleeper {
public:
  explicit Sleeper(const std::string& device) : pid_(::fork()) {
    REQUIRE(pid_ >= 0);
    if (pid_ > 0) {
      while (users_of(device).empty()) std::this_thread::sleep_for(1ms);
      return;
    }
    ::open(device.c_str(), O_RDWR | O_NOCTTY);
    while (true) ::pause();
  }
  ~Sleeper() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Sleeper(const Sleeper&) = delete;
  Sleeper& operator=(const Sleeper&) = delete;

  [[nodiscard]] pid_t pid() const { return pid_; }

private:
  pid_t pid_;
};

SCENARIO("bytes pass through a serial line unchanged") {
  GIVEN("a line at 500000 baud") {
    const Beacon beacon;
    Host host{.port = open_serial_port(beacon.device(), 500'000)};
    CHECK(host.port->name() == beacon.device());
    CHECK(host.port->description() == beacon.device() + " at 500000 baud");
    REQUIRE(host.next().status == ReadStatus::connected);
    CHECK(host.port->last_error().empty());
    WHEN("every byte value is sent, including those with a meaning for terminals") {
      std::string all(256, '\0');
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<char>(i);
      const SteadyTime before = clocks::steady_now();
      beacon.send(all);
      THEN("they arrive unchanged, with a time, and nothing is echoed") {
        CHECK(host.bytes(256) == all);
        beacon.send("x");
        const ReadResult result = host.next();
        CHECK(result.size == 1);
        CHECK(result.arrival >= before);
        CHECK(result.arrival <= clocks::steady_now());
        CHECK_FALSE(beacon.got_an_echo());
      }
    }
    WHEN("nothing is sent") {
      const auto before = std::chrono::steady_clock::now();
      CHECK(host.port->read(host.buffer, 40ms).status == ReadStatus::timeout);
      const auto waited = std::chrono::steady_clock::now() - before;
      THEN("a read waits for its timeout, and the next still reads") {
        CHECK(waited >= 40ms);
        beacon.send("ok");
        CHECK(host.bytes(2) == "ok");
      }
    }
  }
  GIVEN("a non-standard baud rate") {
    const Beacon beacon;
    Host host{.port = open_serial_port(beacon.device(), 123'456)};
    REQUIRE(host.next().status == ReadStatus::connected);
    beacon.send("odd");
    CHECK(host.bytes(3) == "odd");
  }
}

SCENARIO("the port waits for an unplugged device and opens it again") {
  GIVEN("a device behind a link, as udev creates it") {
    const TemporaryFolder dev;
    const auto link = dev / "beacon";
    auto beacon = std::make_unique<Beacon>();
    std::filesystem::create_symlink(beacon->device(), link);
    Host host{.port = open_serial_port(link.string(), 115'200)};
    REQUIRE(host.next().status == ReadStatus::connected);
    beacon->send("before");
    REQUIRE(host.bytes(6) == "before");
    WHEN("it is unplugged") {
      beacon.reset();
      std::filesystem::remove(link);
      THEN("that is reported once, with its cause, and the port waits") {
        CHECK(host.next().status == ReadStatus::disconnected);
        CHECK_FALSE(host.port->last_error().empty());
        CHECK(host.port->read(host.buffer, 350ms).status == ReadStatus::timeout);
        CHECK_THAT(host.port->last_error(), Contains("does not exist") && Contains("serial device"));
        AND_WHEN("another device appears under the same link") {
          const Beacon other;
          const Beacon again;
          std::filesystem::create_symlink(again.device(), link);
          THEN("it is opened and read") {
            CHECK(host.next().status == ReadStatus::connected);
            again.send("after");
            CHECK(host.bytes(5) == "after");
            CHECK(host.port->last_error().empty());
          }
        }
      }
    }
  }
  GIVEN("a device that is absent at the start") {
    const TemporaryFolder dev;
    const auto link = dev / "beacon";
    Host host{.port = open_serial_port(link.string(), 115'200)};
    THEN("that is reported once, and it is opened when it appears") {
      CHECK(host.next().status == ReadStatus::disconnected);
      CHECK(host.port->read(host.buffer, 250ms).status == ReadStatus::timeout);
      const Beacon beacon;
      std::filesystem::create_symlink(beacon.device(), link);
      CHECK(host.next().status == ReadStatus::connected);
    }
    THEN("a device that appears, but cannot be used, is reported too, and so is its absence again") {
      CHECK(host.next().status == ReadStatus::disconnected);
      std::filesystem::create_symlink("/dev/null", link);
      CHECK(host.next().status == ReadStatus::disconnected);
      CHECK(host.port->state() == LineState::failed);
      CHECK(host.port->read(host.buffer, 250ms).status == ReadStatus::timeout);
      std::filesystem::remove(link);
      CHECK(host.next().status == ReadStatus::disconnected);
      CHECK(host.port->state() == LineState::waiting);
    }
  }
}

SCENARIO("a line has one reader only, even of the superuser, whom TIOCEXCL does not stop") {
  GIVEN("a line with a reader") {
    const Beacon beacon;
    std::unique_ptr<Host> first(new Host{.port = open_serial_port(beacon.device(), 115'200)});
    REQUIRE(first->next().status == ReadStatus::connected);
    Host second{.port = open_serial_port(beacon.device(), 115'200)};
    THEN("a second one waits, and says why; the first one gets every byte") {
      CHECK(second.next().status == ReadStatus::disconnected);
      CHECK(second.port->state() == LineState::failed);
      CHECK_THAT(second.port->last_error(), Contains("in use"));
      beacon.send("all bytes");
      CHECK(first->bytes(9) == "all bytes");
      AND_WHEN("the first one leaves") {
        first.reset();
        THEN("the second one reads") {
          CHECK(second.next().status == ReadStatus::connected);
          beacon.send("more");
          CHECK(second.bytes(4) == "more");
        }
      }
    }
  }
  GIVEN("another process that has the line open without a lock, such as a terminal program") {
    const Beacon beacon;
    const Sleeper other(beacon.device());
    Host host{.port = open_serial_port(beacon.device(), 115'200)};
    REQUIRE(host.next().status == ReadStatus::connected);
    THEN("it is named") {
      CHECK_THAT(host.port->description(),
                 Contains("(process " + std::to_string(other.pid()) + ") has it open"));
    }
  }
}

SCENARIO("a path that can never be a serial line is refused at once") {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  for (const std::string& path :
       {(folder / "file").string(), folder.path().string(), (folder / "pipe").string(),
        std::string("/dev/null"), std::string(), std::string(" "), std::string("ttyUSB77")}) {
    CHECK_THROWS_WITH(open_serial_port(path, 115'200), Contains('"' + path + "\" is not a serial device"));
  }
  CHECK_THROWS_WITH(open_serial_port("/dev/ttyACM0", 0), Contains("baud rate of 0"));
}

SCENARIO("a stop ends the reads of a serial port") {
  std::array<std::uint8_t, 16> buffer{};
  /// Stops the port during a read that would last for an hour.
  const auto stop_while_reading = [&buffer](ByteLink& port) {
    std::thread stopper([&port] {
      std::this_thread::sleep_for(50ms);  // lets the read begin
      port.stop();
    });
    ReadStatus status = ReadStatus::connected;
    while (status == ReadStatus::connected || status == ReadStatus::disconnected) {
      status = port.read(buffer, 1h).status;
    }
    stopper.join();
    return status;
  };
  GIVEN("a silent device") {
    const Beacon beacon;
    const auto port = open_serial_port(beacon.device(), 115'200);
    THEN("it ends a read") {
      CHECK(stop_while_reading(*port) == ReadStatus::stopped);
    }
  }
  GIVEN("a device that is absent") {
    const auto port = open_serial_port("/dev/sonopose-no-such-device", 115'200);
    THEN("it ends a read") {
      CHECK(stop_while_reading(*port) == ReadStatus::stopped);
    }
  }
  GIVEN("a stop before the first read") {
    const Beacon beacon;
    const auto port = open_serial_port(beacon.device(), 115'200);
    port->stop();
    THEN("the read ends at once") {
      CHECK(port->read(buffer, 1h).status == ReadStatus::stopped);
    }
  }
}

SCENARIO("a line sends while it reads") {
  const std::vector<std::uint8_t> message{'p', 'o', 's', 'e', 0, 10, 13};
  const std::string text(message.begin(), message.end());
  GIVEN("an open line") {
    const Beacon autopilot;
    Host host{.port = open_serial_port(autopilot.device(), 921'600)};
    REQUIRE(host.next().status == ReadStatus::connected);
    WHEN("another thread sends") {
      std::thread sender([&] { host.port->send(message); });
      sender.join();
      std::string got;
      const bool is_complete = sonopose::test::wait_until([&] {
        host.port->read(host.buffer, 10ms);
        got += autopilot.received();
        return got.size() >= text.size();
      });
      THEN("the bytes arrive unchanged") {
        CHECK(is_complete);
        CHECK(got == text);
        CHECK(host.port->unsent() == 0);
      }
    }
    WHEN("more is sent than the line takes") {
      for (int i = 0; i < 100; ++i) host.port->send(std::vector<std::uint8_t>(4096, 'x'));
      host.port->read(host.buffer, 10ms);
      THEN("the rest is counted, and nothing waits") {
        CHECK(host.port->unsent() > 0);
      }
    }
  }
  GIVEN("a device that is absent") {
    Host host{.port = open_serial_port("/dev/sonopose-no-such-device", 921'600)};
    host.port->send(message);
    host.port->read(host.buffer, 10ms);
    host.port->read(host.buffer, 200ms);
    THEN("what is sent is not counted: the line is no reason") {
      CHECK(host.port->unsent() == 0);
    }
  }
}

}  // namespace serial_port_test
