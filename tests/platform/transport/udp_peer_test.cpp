/// Datagrams to and from one machine, on loopback addresses that stand for machines.

#include "transport/udp_peer.hpp"

#include <catch2/catch.hpp>

#include <arpa/inet.h>
#include <array>
#include <chrono>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace udp_peer_test {

using namespace sonopose;
using namespace sonopose::transport;
using namespace std::chrono_literals;
using Catch::Contains;

/// A socket of a machine, on a port that the system chooses.
class Port {
public:
  explicit Port(const std::string& address = "127.0.0.1")
      : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    REQUIRE(descriptor_ >= 0);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    REQUIRE(::inet_pton(AF_INET, address.c_str(), &own.sin_addr) == 1);
    REQUIRE(::bind(descriptor_, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0);
    socklen_t size = sizeof own;
    REQUIRE(::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&own), &size) == 0);
    endpoint_ = {.address = address, .port = ntohs(own.sin_port)};
    const timeval limit{.tv_sec = 20, .tv_usec = 0};
    REQUIRE(::setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit) == 0);
  }
  ~Port() { ::close(descriptor_); }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  [[nodiscard]] const Endpoint& endpoint() const { return endpoint_; }

  /// The next datagram; its sender becomes that to which send() sends.
  std::string receive() {
    std::string text(2048, '\0');
    socklen_t size = sizeof sender_;
    const auto count =
        ::recvfrom(descriptor_, text.data(), text.size(), 0, reinterpret_cast<sockaddr*>(&sender_), &size);
    text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    return text;
  }
  void send(const std::string& text) const { send(text, sender_); }
  void send(const std::string& text, const sockaddr_in& to) const {
    REQUIRE(::sendto(descriptor_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                     sizeof to) == static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] const sockaddr_in& sender() const { return sender_; }

private:
  int descriptor_;
  Endpoint endpoint_;
  sockaddr_in sender_{};
};

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

/// The program's end.
struct Host {
  std::unique_ptr<ByteLink> peer;
  std::array<std::uint8_t, 2048> buffer{};

  /// Sends, which the reading thread does.
  void send(const std::string& text) {
    peer->send(bytes_of(text));
    peer->read(buffer, 10ms);
  }
  /// The status and text of the next datagram.
  std::pair<ReadStatus, std::string> next() {
    for (int i = 0; i < 200; ++i) {
      const ReadResult result = peer->read(buffer, 100ms);
      if (result.status == ReadStatus::timeout) continue;
      return {result.status,
              std::string(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(result.size))};
    }
    return {};
  }
};

SCENARIO("messages go to the endpoint, or to the port that was accepted as theirs") {
  GIVEN("a peer that has sent to an autopilot") {
    Port autopilot;
    Host host{.peer = open_udp_peer(autopilot.endpoint(), 0)};
    const std::string all_bytes("pose\0\n\xff", 7);
    host.send(all_bytes);
    REQUIRE(autopilot.receive() == all_bytes);
    CHECK(host.peer->unsent() == 0);
    CHECK(host.peer->send_failures().count == 0);
    CHECK(host.peer->name() == "udp 127.0.0.1 port " + std::to_string(autopilot.endpoint().port));
    WHEN("another program of its machine sends") {
      Port other;
      other.send("heartbeat", autopilot.sender());
      REQUIRE(host.next() == std::pair(ReadStatus::data, std::string("heartbeat")));
      THEN("it is read, and messages still go to the endpoint") {
        host.send("1");
        CHECK(autopilot.receive() == "1");
        AND_WHEN("it is accepted") {
          host.peer->answer_last_sender();
          host.send("2");
          THEN("they go there") {
            CHECK(other.receive() == "2");
          }
        }
      }
    }
    WHEN("another machine sends") {
      const Port stranger("127.0.0.2");
      stranger.send("heartbeat", autopilot.sender());
      THEN("it is refused, and accepting the last sender does not mean it") {
        CHECK(host.next().first == ReadStatus::refused);
        host.peer->answer_last_sender();
        host.send("1");
        CHECK(autopilot.receive() == "1");
      }
    }
  }
  GIVEN("a machine where no program has the port") {
    Endpoint closed;
    {
      const Port port;
      closed = port.endpoint();
    }
    Host host{.peer = open_udp_peer(closed, 0)};
    THEN("sending and reading go on") {
      for (int i = 0; i < 3; ++i) host.send("1");
      CHECK(host.peer->read(host.buffer, 10ms).status == ReadStatus::timeout);
    }
  }
}

SCENARIO("a message that cannot be sent is counted, with the cause") {
  GIVEN("a peer at the address of all machines, to which a socket may not send") {
    Host host{.peer = open_udp_peer({.address = "255.255.255.255", .port = 14550}, 0)};
    host.send("1");
    CHECK(host.peer->send_failures().count == 1);
    CHECK(host.peer->send_failures().reason != std::errc{});
  }
  GIVEN("a message that is longer than any datagram") {
    Port autopilot;
    Host host{.peer = open_udp_peer(autopilot.endpoint(), 0)};
    host.send(std::string(70'000, 'x'));
    THEN("it is counted with its cause, also after one that is sent, and the line is not full") {
      host.send("1");
      CHECK(autopilot.receive() == "1");
      CHECK(host.peer->send_failures().count == 1);
      CHECK(host.peer->send_failures().reason == std::errc::message_size);
      CHECK(host.peer->unsent() == 0);
    }
  }
}

SCENARIO("a local port that is in use is refused") {
  const Port taken("0.0.0.0");
  CHECK_THROWS_WITH(
      open_udp_peer({.address = "127.0.0.1", .port = 14550}, taken.endpoint().port),
      Contains("udp 127.0.0.1 port 14550: cannot bind local port " + std::to_string(taken.endpoint().port)));
}

SCENARIO("a stop ends the read of a silent peer") {
  const Port autopilot;
  const auto peer = open_udp_peer(autopilot.endpoint(), 0);
  std::thread stopper([&peer] {
    std::this_thread::sleep_for(50ms);  // lets the read begin
    peer->stop();
  });
  std::array<std::uint8_t, 16> buffer{};
  CHECK(peer->read(buffer, 1h).status == ReadStatus::stopped);
  stopper.join();
}

}  // namespace udp_peer_test
