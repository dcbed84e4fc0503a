#include "dds/dds_fixture.hpp"
#include <sonopose/dds/qos/match.hpp>

#include <catch2/catch.hpp>

#include <string>

namespace sonopose::dds::test::qos_file_test {

TEST_CASE("The project's QoS file has the policies that its streams need") {
  const qos::Provider provider = project_qos();
  using std::chrono::milliseconds;
  SECTION("IMU and pose: reliable, depth 64 or more, and a stalled consumer blocks writers only briefly") {
    for (const char* const name : {"sonopose::Imu", "sonopose::Pose"}) {
      for (const Qos* const qos : {&provider.datawriter_qos(name), &provider.datareader_qos(name)}) {
        CHECK(qos->policy<policy::Reliability>()->kind() == policy::ReliabilityKind::RELIABLE);
        CHECK(qos->policy<policy::History>()->depth() >= 64);
        CHECK(qos->policy<policy::LatencyBudget>()->duration() == core::Duration::zero());
        // the slowest supported IMU sends a sample every 40 ms
        CHECK(qos->policy<policy::Deadline>()->period() > core::Duration::from_millisecs(40));
      }
      CHECK(provider.datawriter_qos(name).policy<policy::Reliability>()->max_blocking_time() <=
            core::Duration::from_millisecs(5));
    }
  }
  SECTION("the pose alone is exclusive, on both sides") {
    const auto exclusive = [&](const char* profile) {
      const auto of_writer = provider.datawriter_qos(profile).policy<policy::Ownership>();
      const auto of_reader = provider.datareader_qos(profile).policy<policy::Ownership>();
      CHECK(of_writer.has_value() == of_reader.has_value());
      return of_reader && of_reader->kind() == policy::OwnershipKind::EXCLUSIVE;
    };
    CHECK(exclusive("sonopose::Pose"));
    CHECK(exclusive("sonopose::LosslessPose"));
    for (const char* const name : {"Imu", "Fix", "Heading", "Report", "Status", "Truth", "Command",
                                   "SettingsRequest", "SettingsReply", "Settings"}) {
      CHECK_FALSE(exclusive((std::string("sonopose::") + name).c_str()));
    }
  }
  SECTION("settings requests and replies: reliable, volatile; effective settings are kept for late joiners") {
    for (const char* const name :
         {"sonopose::SettingsRequest", "sonopose::SettingsReply", "sonopose::Settings"}) {
      for (const Qos* const qos : {&provider.datawriter_qos(name), &provider.datareader_qos(name)}) {
        const bool is_settings = std::string(name) == "sonopose::Settings";
        CHECK(qos->policy<policy::Reliability>()->kind() == policy::ReliabilityKind::RELIABLE);
        CHECK(qos->policy<policy::Durability>()->kind() ==
              (is_settings ? policy::DurabilityKind::TRANSIENT_LOCAL : policy::DurabilityKind::VOLATILE));
        CHECK(qos->policy<policy::History>()->kind() == policy::HistoryKind::KEEP_LAST);
        CHECK(qos->policy<policy::History>()->depth() == (is_settings ? 1 : 64));
        // settings may stay unchanged forever
        const auto deadline = qos->policy<policy::Deadline>();
        if (deadline) CHECK(deadline->period() == core::Duration::infinite());
      }
    }
    // The fusion writes these on the thread that makes poses.
    for (const char* const name : {"sonopose::SettingsReply", "sonopose::Settings"}) {
      CHECK(provider.datawriter_qos(name).policy<policy::Reliability>()->max_blocking_time() <=
            core::Duration::from_millisecs(5));
    }
  }
  SECTION("lossless: both sides keep all") {
    for (const char* const name : {"Imu", "Fix", "Heading", "Pose", "Report"}) {
      const std::string profile = std::string("sonopose::Lossless") + name;
      CHECK(provider.datawriter_qos(profile).policy<policy::History>()->kind() ==
            policy::HistoryKind::KEEP_ALL);
      CHECK(provider.datareader_qos(profile).policy<policy::History>()->kind() ==
            policy::HistoryKind::KEEP_ALL);
      CHECK(provider.datawriter_qos(profile).policy<policy::Reliability>()->max_blocking_time() >=
            core::Duration::from_millisecs(100));
    }
  }
  SECTION(
      "native topics and ros_discovery_info: both sides have user data, without which ROS 2's Jazzy warns of "
      "each") {
    for (const char* const name : {"sonopose::Imu", "sonopose::LosslessFix", "sonopose::Log",
                                   "sonopose::Pose", "sonopose::SettingsReply", "ros2::Discovery"}) {
      for (const Qos* const qos : {&provider.datawriter_qos(name), &provider.datareader_qos(name)}) {
        REQUIRE(qos->policy<policy::UserData>());
        const auto bytes = qos->policy<policy::UserData>()->value();
        CHECK(std::string(bytes.begin(), bytes.end()) == "sonopose=1;");
      }
    }
  }
}

/// QoS of a ROS 2 node's endpoint: rmw's defaults with these policies.
Qos ros_end(policy::ReliabilityKind::Type reliability, policy::DurabilityKind::Type durability,
            std::uint32_t depth) {
  return Qos() << policy::Reliability(reliability) << policy::Durability(durability)
               << policy::History::KeepLast(depth);
}

TEST_CASE("The profiles for ROS 2 match what ROS 2 nodes use by default") {
  using Kind = policy::ReliabilityKind;
  using Durability = policy::DurabilityKind;
  const qos::Provider provider = project_qos();
  const Qos usual = ros_end(Kind::RELIABLE, Durability::VOLATILE, 10);
  const Qos sensor_data = ros_end(Kind::BEST_EFFORT, Durability::VOLATILE, 5);
  const Qos transient = ros_end(Kind::RELIABLE, Durability::TRANSIENT_LOCAL, 1);
  const auto match = [](const Qos& writer, const Qos& reader) {
    return qos::mismatches(writer, reader).empty();
  };

  SECTION("rclcpp's default and sensor data, both ways") {
    for (const char* const name : {"ros2::Default", "ros2::SensorData", "ros2::Tf", "ros2::Diagnostics"}) {
      CAPTURE(name);
      CHECK(match(provider.datawriter_qos(name), usual));
      CHECK(match(provider.datawriter_qos(name), sensor_data));
      CHECK(match(usual, provider.datareader_qos(name)));
    }
    CHECK(match(sensor_data, provider.datareader_qos("ros2::SensorData")));
    CHECK(match(sensor_data, provider.datareader_qos("ros2::Input")));
    CHECK(match(usual, provider.datareader_qos("ros2::Input")));
    CHECK_FALSE(match(sensor_data, provider.datareader_qos("ros2::Default")));
  }
  SECTION("data for late joiners is kept") {
    for (const char* const name : {"ros2::TfStatic", "ros2::Discovery"}) {
      CAPTURE(name);
      CHECK(match(provider.datawriter_qos(name), transient));
      CHECK(match(transient, provider.datareader_qos(name)));
      CHECK(provider.datawriter_qos(name).policy<policy::History>()->depth() == 1);
      CHECK_FALSE(match(usual, provider.datareader_qos(name)));
    }
  }
  SECTION("depths are those of rclcpp, tf2_ros and rmw_dds_common") {
    const auto depth = [](const Qos& qos) { return qos.policy<policy::History>()->depth(); };
    CHECK(depth(provider.datawriter_qos("ros2::Default")) == 10);
    CHECK(depth(provider.datareader_qos("ros2::SensorData")) == 5);
    CHECK(depth(provider.datawriter_qos("ros2::Tf")) == 100);
    CHECK(provider.datareader_qos("ros2::Discovery").policy<policy::History>()->kind() ==
          policy::HistoryKind::KEEP_ALL);
  }
}

}  // namespace sonopose::dds::test::qos_file_test
