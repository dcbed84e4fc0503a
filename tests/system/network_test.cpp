// The network of the programs, in a network namespace with interfaces of its own.

#include "support/notify_socket.hpp"
#include "support/process.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace sonopose::test::network_test {

using Catch::Contains;
using Catch::StartsWith;

/// Runs a shell script in a network namespace whose interfaces are all down.
Result in_namespace(const std::string& script) {
  return run("/usr/bin/env", {"unshare", "--user", "--map-root-user", "--net", "sh", "-ec", script},
             {{"CYCLONEDDS_URI", ""}, {"ROS_DOMAIN_ID", "5"}});
}

/// A cable whose other end is the bridge docker0, which so has a carrier, too.
const std::string add_wlan0 =
    "ip link add wlan0 type veth peer name ap; ip link set ap up; "
    "ip addr add 192.0.2.5/24 dev wlan0; ip link set wlan0 up; ip route add default via 192.0.2.1; ";
const std::string add_docker0 =
    "ip link add docker0 type bridge; ip link set ap master docker0; "
    "ip addr add 172.17.0.1/16 dev docker0; ip link set docker0 up; ";

bool has_namespaces() {
  static const bool are_made = in_namespace(add_wlan0 + add_docker0).code == 0;
  if (are_made) return true;
  WARN(
      "skipped: no network namespace with veth and bridge can be made; allow user namespaces "
      "(sysctl kernel.unprivileged_userns_clone=1) and install iproute2");
  return false;
}

SCENARIO("a program on the lan waits for the network, and takes the one with the default route") {
  if (!has_namespaces()) return;
  const TemporaryFolder folder;
  const std::string log = (folder.path() / "bridge.log").string();
  GIVEN("a bridge that starts with loopback alone") {
    WHEN("wlan0 comes up, then docker0, and a monitor starts") {
      const Result result = in_namespace(
          "ip link set lo up; " SONOPOSE_TEST_BRIDGE " --network lan --source sim 2> " + log +
          " & bridge=$!; trap 'kill $bridge; wait' EXIT; until grep -q 'waiting for the network' " + log +
          "; do kill -0 $bridge; sleep 0.1; done; " + add_wlan0 + "until grep -q 'network: wlan0' " + log +
          "; do kill -0 $bridge; sleep 0.1; done; " + add_docker0 +
          SONOPOSE_TEST_MONITOR " --network lan --echo sonopose/imu --count 1 --duration 100; cat " + log);
      THEN("the monitor receives the bridge's samples, and both say what they use and why") {
        CAPTURE(result.output, result.error);
        CHECK(result.code == 0);
        CHECK_THAT(result.output,
                   Contains("no network interface is up with an IPv4 address, only lo (127.0.0.1)") &&
                       Contains("specific_force"));
        CHECK_THAT(result.error,
                   Contains("network: wlan0 (192.0.2.5), it has the default route; not docker0"));
      }
    }
  }
  GIVEN("a service manager with a watchdog, and a bridge that starts with loopback alone") {
    NotifySocket manager(folder / "notify");
    WHEN("it waits") {
      const Result result =
          in_namespace("ip link set lo up; NOTIFY_SOCKET=" + (folder / "notify").string() +
                       " WATCHDOG_USEC=1500000 " SONOPOSE_TEST_BRIDGE " --network lan --source sim 2> " +
                       log + " & bridge=$!; until grep -q 'waiting for the network' " + log +
                       "; do kill -0 $bridge; sleep 0.1; done; kill $bridge; wait");
      THEN("the manager neither ends its start nor the process, and knows why it does not serve") {
        CAPTURE(result.output, result.error);
        CHECK(manager.next(0) == "READY=1");
        CHECK(manager.next(0) == "WATCHDOG=1");
        CHECK_THAT(manager.next(0), StartsWith("STATUS=waiting for the network: "));
      }
    }
  }
  GIVEN("a bridge on loopback, and wlan0") {
    WHEN("the doctor looks at the lan") {
      const Result result =
          in_namespace("ip link set lo up; " + add_wlan0 + SONOPOSE_TEST_BRIDGE " --source sim 2> " + log +
                       " & bridge=$!; trap 'kill $bridge; wait' EXIT; until grep -q publishing " + log +
                       "; do kill -0 $bridge; sleep 0.1; done; " SONOPOSE_TEST_DOCTOR
                       " --network lan --duration 0.5 || true");
      THEN("it finds the bridge, and says how to reach it") {
        CAPTURE(result.output, result.error);
        CHECK_THAT(result.output,
                   Contains("beacons are published on loopback of this machine: use --network loopback"));
      }
    }
  }
  GIVEN("loopback alone") {
    WHEN("the relay starts with the range of ROS 2's default") {
      const Result result = in_namespace(
          "ip link set lo up; unset ROS_AUTOMATIC_DISCOVERY_RANGE ROS_LOCALHOST_ONLY "
          "ROS_STATIC_PEERS; " SONOPOSE_TEST_ROS2 " 2> " +
          log + " & relay=$!; until grep -q 'network: ' " + log +
          "; do kill -0 $relay; sleep 0.1; done; kill $relay; wait; cat " + log);
      THEN("it serves this machine, and warns that it finds no other") {
        CAPTURE(result.output, result.error);
        CHECK_THAT(result.output,
                   Contains("only lo (127.0.0.1); other machines are found only after a restart"));
      }
    }
    WHEN("the doctor looks at the lan") {
      const Result result =
          in_namespace("ip link set lo up; " SONOPOSE_TEST_DOCTOR " --network lan --duration 0.5 || true");
      THEN("it says that the network is missing, without waiting for it") {
        CAPTURE(result.output, result.error);
        CHECK_THAT(result.output, Contains("no network interface is up with an IPv4 address, only lo") &&
                                      !Contains("this machine only") && !Contains("--network lan on both"));
      }
    }
  }
}

}  // namespace sonopose::test::network_test
