#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/udp_sender.hpp"
#include "transport/byte_file.hpp"
#include "transport/udp_listener.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>

namespace devices_test {

using namespace sonopose;
using namespace sonopose::transport;
using namespace sonopose::files;
using namespace std::chrono_literals;
using Catch::Contains;
using sonopose::test::read_text;
using sonopose::test::TemporaryFolder;
using sonopose::test::UdpSender;
using sonopose::test::write_text;

std::string text_of(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

SCENARIO("an address to listen on is parsed, or refused with the cause") {
  CHECK(parse_endpoint("0.0.0.0:49100") == Endpoint{"0.0.0.0", 49100});
  CHECK(parse_endpoint("[::1]:1") == Endpoint{"::1", 1});
  CHECK(parse_endpoint("127.0.0.1:0") == Endpoint{"127.0.0.1", 0});
  const auto refusal = [](const char* text) {
    try {
      parse_endpoint(text);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(refusal("49100") == "\"49100\" is not ADDR:PORT: the colon and the port are missing");
  CHECK_THAT(refusal("127.0.0.1:"), Contains("\"\" is not a port from 0 to 65535"));
  CHECK_THAT(refusal("127.0.0.1:65536"), Contains("\"65536\" is not a port"));
  CHECK_THAT(refusal("127.0.0.1:-1"), Contains("\"-1\" is not a port"));
  CHECK_THAT(refusal("127.0.0.1:80x"), Contains("\"80x\" is not a port"));
  CHECK_THAT(refusal("localhost:80"), Contains("\"localhost\" is not a numeric IP address"));
  CHECK_THAT(refusal(":80"), Contains("\"\" is not a numeric IP address"));
  CHECK_THAT(refusal("::1:80"), Contains("needs brackets"));
}

/// The port that the system chose.
std::uint16_t port_of(const ByteSource& listener) {
  const std::string name = listener.name();
  REQUIRE(name.starts_with("udp 127.0.0.1:"));
  return parse_endpoint(name.substr(4)).port;
}

SCENARIO("datagrams are read one by one, with their arrival time") {
  GIVEN("a listener on loopback, on a port chosen by the system") {
    const auto listener = open_udp_listener(parse_endpoint("127.0.0.1:0"));
    const std::uint16_t port = port_of(*listener);
    REQUIRE(port != 0);
    const UdpSender sender(port);
    std::array<std::uint8_t, 2048> buffer{};
    WHEN("nothing is sent") {
      THEN("the read ends in time, and the next one still works") {
        const auto before = std::chrono::steady_clock::now();
        CHECK(listener->read(buffer, 30ms).status == ReadStatus::timeout);
        CHECK(std::chrono::steady_clock::now() - before >= 30ms);
        sender.send("late");
        CHECK(listener->read(buffer, 60s).size == 4);
      }
    }
    WHEN("two datagrams and an empty one are sent") {
      const SteadyTime before = clocks::steady_now();
      sender.send("first");
      sender.send("");
      sender.send("second one");
      THEN("each is read alone and complete") {
        const ReadResult first = listener->read(buffer, 60s);
        REQUIRE(first.status == ReadStatus::data);
        CHECK(text_of(std::span(buffer).first(first.size)) == "first");
        CHECK(first.arrival >= before);
        CHECK(first.arrival <= clocks::steady_now());
        const ReadResult empty = listener->read(buffer, 60s);
        CHECK(empty.status == ReadStatus::data);
        CHECK(empty.size == 0);
        const ReadResult second = listener->read(buffer, 60s);
        CHECK(text_of(std::span(buffer).first(second.size)) == "second one");
      }
    }
    WHEN("another listener binds the same port") {
      THEN("it gets the cause") {
        CHECK_THROWS_WITH(open_udp_listener({"127.0.0.1", port}),
                          Contains("cannot listen on 127.0.0.1:") && Contains("already in use"));
      }
    }
    WHEN("another thread stops it") {
      std::thread stopper([&] {
        std::this_thread::sleep_for(50ms);  // lets the read begin
        listener->stop();
      });
      const ReadResult result = listener->read(buffer, 1h);
      stopper.join();
      THEN("the read ends, and so does the next one") {
        CHECK(result.status == ReadStatus::stopped);
        CHECK(listener->read(buffer, 1h).status == ReadStatus::stopped);
      }
    }
  }
  GIVEN("a listener that accepts this machine only") {
    const auto listener = open_udp_listener(parse_endpoint("127.0.0.1:0"), "127.0.0.1");
    const std::uint16_t port = port_of(*listener);
    std::array<std::uint8_t, 2048> buffer{};
    WHEN("two programs of this machine send") {
      const UdpSender beacon(port);
      beacon.send("beacon");
      const UdpSender forger(port);
      forger.send("forged");
      THEN("they are different senders, by their ports") {
        const ReadResult first = listener->read(buffer, 60s);
        const ReadResult second = listener->read(buffer, 60s);
        REQUIRE(second.status == ReadStatus::data);
        CHECK(first.sender.port != 0);
        CHECK(first.sender.address == second.sender.address);
        CHECK(first.sender.port != second.sender.port);
      }
    }
  }
  GIVEN("an address of another machine") {
    CHECK_THROWS_AS(open_udp_listener(Endpoint{"192.0.2.1", 0}), IoError);
  }
}

SCENARIO("a file of bytes is played to its end") {
  const TemporaryFolder folder;
  std::string bytes(10'000, '\0');
  std::iota(bytes.begin(), bytes.end(), '\0');
  write_text(folder / "stream.bin", bytes);
  ByteFile file(folder / "stream.bin");
  std::array<std::uint8_t, 777> buffer{};
  THEN("every byte is read, in order, then the end") {
    std::string read;
    ReadResult result = file.read(buffer, 1s);
    for (; result.status == ReadStatus::data; result = file.read(buffer, 1s)) {
      CHECK(result.arrival > SteadyTime{});
      read += text_of(std::span(buffer).first(result.size));
    }
    CHECK(result.status == ReadStatus::end);
    CHECK(read == bytes);
  }
  THEN("it can be stopped") {
    file.stop();
    CHECK(file.read(buffer, 1s).status == ReadStatus::stopped);
  }
  THEN("a missing file or a folder is reported by name") {
    CHECK_THROWS_WITH(ByteFile(folder / "none.bin"), Contains("none.bin: does not exist"));
    CHECK_THROWS_WITH(ByteFile(folder.path()), Contains("is a folder, not a file"));
  }
}

}  // namespace devices_test
