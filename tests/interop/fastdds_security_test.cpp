/// A program with Fast DDS on a secured bus, with the files of our key store.

#include "support/secured_bus.hpp"
#include "support/wait_until.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace fastdds_security_test {

using namespace sonopose;
using namespace sonopose::test;

/// A secured bus with the enclaves of two peers, which differ in who begins the handshake.
struct SecuredPeers {
  SecuredPeers() {
    add("panel", {"ros2"}, security::Handshake::answers);
    add("rviz2", {"ros2"}, security::Handshake::either);  // a lower hash of its subject than that of "ros2"
    add("relay", {"ros2", "bridge"}, security::Handshake::either);
  }

  void add(const std::string& name, const std::vector<std::string>& roles,
           security::Handshake handshake) const {
    keys.store.add(name, {.roles = roles, .validity = valid_for(security::day_s), .handshake = handshake});
  }

  [[nodiscard]] std::unique_ptr<Process> peer(const std::string& enclave, const Arguments& arguments) const {
    const Environment variables{{"ROS_DOMAIN_ID", std::to_string(bus.domain_id())},
                                {"ROS_SECURITY_ENCLAVE_OVERRIDE", enclave}};
    return std::make_unique<Process>(SONOPOSE_TEST_FASTDDS_PEER, arguments, variables);
  }

  /// Returns true if a process ends well beside some peers, which may be one of them. Fast DDS 2.9 can miss
  /// the last message of a handshake, which neither side repeats or reports, so a further peer starts then.
  [[nodiscard]] bool serves_one(const Arguments& arguments, Process* process = nullptr) const {
    constexpr std::size_t max_peers = 12;
    constexpr std::chrono::seconds period(3);
    std::vector<std::unique_ptr<Process>> all;
    auto due = std::chrono::steady_clock::now();
    const auto has_ended_well = [](Process& one) {
      return one.wait_for_exit(std::chrono::milliseconds(0)) == 0;
    };
    return wait_until([&] {
      if (all.size() < max_peers && std::chrono::steady_clock::now() >= due) {
        all.push_back(peer("panel", arguments));
        due += period;
      }
      if (process != nullptr) return has_ended_well(*process);
      return std::any_of(all.begin(), all.end(), [&](const auto& one) { return has_ended_well(*one); });
    });
  }

  KeyStoreOfRoles keys;
  SecuredByEnvironment environment{keys.store};
  Bus bus;
};

const Arguments listening{"listen", "rt/hedge_7/odom", "odometry", "20"};

SCENARIO("A program with Fast DDS receives the poses of a secured relay") {
  const SecuredPeers peers;
  const auto relay = peers.bus.ros2();
  const auto fusion = peers.bus.fusion();
  const auto bridge = peers.bus.bridge({});
  WHEN("its certificate lets the relay begin the handshake") {
    THEN("it receives them") {
      CHECK(peers.serves_one(listening));
    }
  }
  WHEN("its certificate lets it begin") {
    const auto peer = peers.peer("rviz2", listening);
    THEN("the relay says what is missing, and serves others") {
      CHECK(relay->wait_for_line(Stream::error, "it probably has Fast DDS, and began the handshake"));
      CHECK(peers.serves_one(listening));
      CHECK(peer->lines(Stream::output).empty());
    }
  }
}

SCENARIO("A secured relay takes the samples of a driver in Fast DDS in") {
  const SecuredPeers peers;
  const auto relay = peers.bus.ros2({"--imu-in", "/driver/imu=9", "--enclave", "relay"});
  const auto monitor = peers.bus.monitor({"--echo", "imu", "--count", "5"});
  WHEN("the driver sends") {
    THEN("the monitor shows them") {
      CHECK(peers.serves_one({"send", "rt/driver/imu", "imu", "1000000", "3fd5555555555555"}, monitor.get()));
    }
  }
}

}  // namespace fastdds_security_test
