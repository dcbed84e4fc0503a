/// A program with Fast DDS on a secured bus, with the files of our key store.

#include "support/secured_bus.hpp"

#include <chrono>
#include <memory>
#include <string>

namespace fastdds_security_test {

using namespace sonopose;
using namespace sonopose::test;

/// A bus with a relay, and the enclaves of two peers, which differ in who begins the handshake.
struct SecuredRelay {
  SecuredRelay() {
    add("panel", security::Handshake::answers);
    add("rviz2", security::Handshake::either);  // a lower hash of its subject than that of "ros2"
  }

  void add(const std::string& name, security::Handshake handshake) const {
    keys.store.add(name, {.roles = {"ros2"}, .validity = valid_for(security::day_s), .handshake = handshake});
  }

  /// A peer that ends after some poses.
  [[nodiscard]] std::unique_ptr<Process> peer(const std::string& enclave) const {
    const Environment variables{{"ROS_DOMAIN_ID", std::to_string(bus.domain_id())},
                                {"ROS_SECURITY_ENCLAVE_OVERRIDE", enclave}};
    auto process = std::make_unique<Process>(
        SONOPOSE_TEST_FASTDDS_PEER, Arguments{"listen", "rt/hedge_7/odom", "odometry", "20"}, variables);
    REQUIRE(process->wait_for_line(Stream::error, "listening"));
    return process;
  }

  /// Returns true if one of some peers receives poses. Fast DDS 2.9 can miss the last message of a handshake,
  /// which neither side repeats.
  [[nodiscard]] bool serves_peer(const std::string& enclave) const {
    constexpr int peers = 12;
    for (int i = 0; i < peers; ++i) {
      if (peer(enclave)->wait_for_exit(std::chrono::seconds(10)) == 0) return true;
    }
    return false;
  }

  KeyStoreOfRoles keys;
  SecuredByEnvironment environment{keys.store};
  Bus bus;
  std::unique_ptr<Process> relay = bus.ros2();
  std::unique_ptr<Process> fusion = bus.fusion();
  std::unique_ptr<Process> bridge = bus.bridge({});
};

SCENARIO("A program with Fast DDS receives the poses of a secured relay") {
  const SecuredRelay bus;
  WHEN("its certificate lets the relay begin the handshake") {
    CHECK(bus.serves_peer("panel"));
  }
  WHEN("its certificate lets it begin") {
    const auto peer = bus.peer("rviz2");
    THEN("the relay says what is missing, and serves others") {
      CHECK(bus.relay->wait_for_line(Stream::error, "it has Fast DDS and began the handshake"));
      CHECK(bus.serves_peer("panel"));
      CHECK(peer->lines(Stream::output).empty());
    }
  }
}

}  // namespace fastdds_security_test
