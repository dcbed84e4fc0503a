/// The UDP path: datagrams of a simulated beacon.

#include "support/beacon_bytes.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace udp_test {

using namespace sonopose;
using namespace sonopose::test;
namespace topics = dds::topics;

/// Sends datagrams to a port of this machine that was recently free.
class Sender {
public:
  Sender() : file_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    REQUIRE(::bind(probe, reinterpret_cast<const sockaddr*>(&to_), sizeof to_) == 0);
    socklen_t size = sizeof to_;
    REQUIRE(::getsockname(probe, reinterpret_cast<sockaddr*>(&to_), &size) == 0);
    ::close(probe);
  }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;
  Sender(Sender&&) = delete;
  Sender& operator=(Sender&&) = delete;
  ~Sender() { ::close(file_); }

  [[nodiscard]] std::string endpoint() const { return "127.0.0.1:" + std::to_string(ntohs(to_.sin_port)); }

  void send(std::span<const std::uint8_t> bytes) const {
    const auto sent =
        ::sendto(file_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    REQUIRE(sent == static_cast<ssize_t>(bytes.size()));
  }

private:
  int file_;
  sockaddr_in to_{};
};

SCENARIO("the datagrams of a beacon give poses") {
  GIVEN("a fusion, a listening bridge, and a beacon at rest") {
    const Bus bus;
    const TemporaryFolder folder;
    const Sender beacon;
    const std::string file = (folder / "bytes.bin").string();
    REQUIRE(bus.bridge({"--scenario", "rest", "--rate", "0", "--duration", "3", "--capture", file,
                        "--address", "21"})
                ->wait_for_exit() == 0);
    const auto datagrams = timed_datagrams(read_bytes(file));
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    REQUIRE(poses.wait_for_writers());
    const auto bridge = bus.bridge({"--source", "udp", "--listen", beacon.endpoint()});
    REQUIRE(bridge->wait_for_line(Stream::error, "publishing from udp"));
    WHEN("the beacon sends") {
      send_in_time(datagrams, [&beacon](std::span<const std::uint8_t> bytes) { beacon.send(bytes); });
      THEN("poses arrive with its address, at its position") {
        CHECK(poses.wait_for([](const FusedPose& pose) {
          return pose.address == 21 && (pose.status & status_initialising) == 0U &&
                 (pose.position_world_m - Vector3d(1.0, 2.0, 0.5)).norm() < 0.10;
        }));
      }
    }
  }
}

}  // namespace udp_test
