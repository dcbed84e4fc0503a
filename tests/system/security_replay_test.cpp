/// Datagrams of a secured bus, handshakes included, that a stranger records and sends again.

#include "secured_chain.hpp"
#include "support/wait_until.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <net/if.h>
#include <netinet/in.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <netpacket/packet.h>
#include <span>
#include <stop_token>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace security_replay_test {

using namespace sonopose;
using namespace sonopose::test;

struct Datagram {
  std::uint16_t port = 0;  ///< port of the receiver
  std::vector<char> bytes;
};

/// Records what is sent to the ports of a domain on loopback, which only root may.
class Recorder {
public:
  explicit Recorder(std::uint32_t domain_id)
      : socket_(::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ipv4))),
        first_port_(7400 + 250 * domain_id) {
    if (socket_ < 0) return;
    sockaddr_ll loopback{};
    loopback.sll_family = AF_PACKET;
    loopback.sll_protocol = htons(ipv4);
    loopback.sll_ifindex = static_cast<int>(::if_nametoindex("lo"));
    const timeval limit{.tv_sec = 0, .tv_usec = 50'000};
    constexpr int buffer = 64 << 20;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &buffer, sizeof buffer);
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    if (::bind(socket_, reinterpret_cast<const sockaddr*>(&loopback), sizeof loopback) != 0) return;
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) receive();
    });
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() {
    finish();
    if (socket_ >= 0) ::close(socket_);
  }

  [[nodiscard]] bool records() const { return thread_.joinable(); }

  /// Ends the recording.
  const std::vector<Datagram>& finish() {
    if (thread_.joinable()) {
      thread_.request_stop();
      thread_.join();
    }
    return recorded_;
  }

private:
  static constexpr std::uint16_t ipv4 = 0x0800;

  void receive() {
    std::array<char, 65536> packet;  // NOLINT(*-member-init): recv fills it
    sockaddr_ll from{};
    socklen_t size = sizeof from;
    const ssize_t length =
        ::recvfrom(socket_, packet.data(), packet.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (length < static_cast<ssize_t>(sizeof(iphdr) + sizeof(udphdr)) || from.sll_pkttype != PACKET_HOST)
      return;
    iphdr ip{};
    std::memcpy(&ip, packet.data(), sizeof ip);
    const std::size_t header = std::size_t{ip.ihl} * 4;
    if (ip.protocol != IPPROTO_UDP || header + sizeof(udphdr) > static_cast<std::size_t>(length)) return;
    udphdr udp{};
    std::memcpy(&udp, packet.data() + header, sizeof udp);
    const std::uint16_t port = ntohs(udp.dest);
    if (port < first_port_ || port >= first_port_ + 250) return;
    recorded_.push_back({port, {packet.data() + header + sizeof udp, packet.data() + length}});
  }

  int socket_;
  std::uint32_t first_port_;
  std::vector<Datagram> recorded_;
  std::jthread thread_;
};

/// A stranger with a port of its own.
class Stranger {
public:
  Stranger() { REQUIRE(socket_ >= 0); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  ~Stranger() { ::close(socket_); }

  /// Sends datagrams again, in their order. Any thread may call it.
  void send_again(std::span<const Datagram> datagrams) const {
    for (std::size_t i = 0; i < datagrams.size(); ++i) {
      sockaddr_in to{};
      to.sin_family = AF_INET;
      to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      to.sin_port = htons(datagrams[i].port);
      ::sendto(socket_, datagrams[i].bytes.data(), datagrams[i].bytes.size(), 0,
               reinterpret_cast<const sockaddr*>(&to), sizeof to);
      if (i % 50 == 49) std::this_thread::sleep_for(std::chrono::milliseconds(2));  // no flood
    }
  }

private:
  int socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

/// True for a datagram of a handshake: its messages are of the topic of stateless messages, which no
/// signature protects.
bool is_of_handshake(const Datagram& datagram) {
  const std::string text(datagram.bytes.begin(), datagram.bytes.end());
  return text.find("dds.sec.auth") != std::string::npos || text.find("DDS:Auth:PKI-DH") != std::string::npos;
}

SCENARIO("a recorded handshake is worth nothing") {
  const KeyStoreOfRoles keys;
  const SecuredByEnvironment environment(keys.store);
  const Bus bus;
  Recorder recorder(bus.domain_id());
  if (!recorder.records()) {
    std::cout << "skipped: no right to record datagrams (CAP_NET_RAW); run it as root\n";
    return;
  }
  const PoseTap tap(bus);
  const auto bridge = bus.bridge(rest);
  auto fusion = bus.fusion();
  REQUIRE(tap.wait_for_count(0, 200).size() >= 200);
  const auto owners = tap.writers();
  const std::vector<Datagram> datagrams = recorder.finish();
  REQUIRE(std::ranges::count_if(datagrams, is_of_handshake) >= 6);  // three messages between two pairs
  const Stranger stranger;
  WHEN("it is sent again to the processes that took part") {
    const std::size_t before = tap.count();
    for (int i = 0; i < 2; ++i) stranger.send_again(datagrams);
    THEN("their poses go on, each is received once, and nobody else writes") {
      TimeNs last_ns = 0;
      const std::size_t wanted = tap.count() - before + 400;
      const auto poses = tap.wait_for_count(before, wanted);
      REQUIRE(poses.size() >= wanted);
      for (const TappedPose& each : poses) {
        REQUIRE(owners.contains(each.writer));
        REQUIRE(each.pose.time_ns > last_ns);
        last_ns = each.pose.time_ns;
      }
      CHECK(tap.writers() == owners);
      AND_WHEN("the fusion is killed, and then all that it has sent arrives again") {
        fusion->send(SIGKILL);
        REQUIRE(fusion->wait_for_exit() == -SIGKILL);
        REQUIRE(wait_until([&] { return tap.writers().empty(); }));
        const std::size_t before_return = tap.count();
        stranger.send_again(datagrams);
        THEN("no pose is received, and the fusion that starts among a third copy serves") {
          const std::jthread sender([&] { stranger.send_again(datagrams); });
          fusion = bus.fusion();
          const auto later = tap.wait_for_count(before_return, 400);
          REQUIRE(later.size() >= 400);
          for (const TappedPose& each : later) {
            REQUIRE_FALSE(owners.contains(each.writer));
            REQUIRE(each.writer == later.front().writer);
          }
        }
      }
    }
  }
}

}  // namespace security_replay_test
