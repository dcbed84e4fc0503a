#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/node/qos_overrides.hpp>

#include <catch2/catch.hpp>

namespace sonopose::qos_overrides_test {

using ros2::QosOverrides;
using Endpoint = QosOverrides::Endpoint;
using Catch::Matchers::Contains;
namespace policy = dds::policy;

/// QoS of an endpoint that is reliable with a depth of 10.
dds::Qos changed(const QosOverrides& overrides, const std::string& topic, Endpoint endpoint) {
  dds::Qos qos;
  qos << policy::Reliability::Reliable() << policy::History::KeepLast(10);
  overrides.apply(topic, endpoint, qos);
  return qos;
}

SCENARIO("parameters of ROS 2 change the QoS of one topic's publisher") {
  GIVEN("overrides of /odom") {
    QosOverrides overrides;
    CHECK(overrides.add("qos_overrides./odom.publisher.reliability", "best_effort"));
    CHECK(overrides.add("qos_overrides./odom.publisher.depth", "3"));
    CHECK(overrides.add("qos_overrides./odom.publisher.durability", "transient_local"));
    CHECK(overrides.add("qos_overrides./odom.publisher.deadline", "500000000"));
    THEN("its publisher has them") {
      const dds::Qos qos = changed(overrides, "/odom", Endpoint::publisher);
      CHECK(qos.policy<policy::Reliability>()->kind() == policy::ReliabilityKind::BEST_EFFORT);
      CHECK(qos.policy<policy::History>()->depth() == 3);
      CHECK(qos.policy<policy::History>()->kind() == policy::HistoryKind::KEEP_LAST);
      CHECK(qos.policy<policy::Durability>()->kind() == policy::DurabilityKind::TRANSIENT_LOCAL);
      CHECK(dds::deadline_of(qos) == std::chrono::milliseconds(500));
    }
    THEN("its subscription and other topics do not") {
      for (const auto& qos : {changed(overrides, "/odom", Endpoint::subscription),
                              changed(overrides, "/pose", Endpoint::publisher)}) {
        CHECK(qos.policy<policy::Reliability>()->kind() == policy::ReliabilityKind::RELIABLE);
        CHECK(qos.policy<policy::History>()->depth() == 10);
      }
    }
  }
  GIVEN("a limit of a profile that keeps all, as ros2::Input") {
    QosOverrides overrides;
    overrides.add("qos_overrides./odom.subscription.history", "keep_last");
    overrides.add("qos_overrides./odom.subscription.depth", "100");
    dds::Qos qos;
    qos << policy::History::KeepAll();
    overrides.apply("/odom", Endpoint::subscription, qos);
    THEN("it has the depth that was asked for") {
      CHECK(qos.policy<policy::History>() == policy::History::KeepLast(100));
    }
  }
  GIVEN("mistakes") {
    QosOverrides overrides;
    THEN("they are named with what is known") {
      CHECK_FALSE(overrides.add("delay.processing_s", "0.07"));
      CHECK_THROWS_WITH(overrides.add("qos_overrides./odom.publisher.reliability", "sure"),
                        Contains("reliability is 'sure': it must be reliable, best_effort"));
      CHECK_THROWS_WITH(overrides.add("qos_overrides./odom.publisher.depth", "0"),
                        Contains("depth is '0': it must be a number from 1"));
      CHECK_THROWS_WITH(overrides.add("qos_overrides./odom.publisher.colour", "red"),
                        Contains("'colour' is not one of the policies"));
      CHECK_THROWS_WITH(overrides.add("qos_overrides.odom.publisher.depth", "1"),
                        Contains("'odom' is not the whole name of a topic"));
      CHECK_THROWS_WITH(overrides.add("qos_overrides./odom.writer.depth", "1"),
                        Contains("'writer' is neither publisher nor subscription"));
    }
  }
}

}  // namespace sonopose::qos_overrides_test
