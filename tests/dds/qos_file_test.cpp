#include "dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <string>

namespace sonopose::dds::test {
namespace {

TEST_CASE("The project's QoS file holds what its streams need") {
  const QosProvider provider = project_qos();
  using std::chrono::milliseconds;
  SECTION("IMU and pose: reliable, 64 deep or more, and a stopped consumer holds nobody up for long") {
    for (const char* const name : {"sonopose::Imu", "sonopose::Pose"}) {
      for (const Qos* const qos : {&provider.datawriter_qos(name), &provider.datareader_qos(name)}) {
        CHECK(qos->policy<policy::Reliability>()->kind == policy::ReliabilityKind::reliable);
        CHECK(qos->policy<policy::History>()->depth >= 64);
        CHECK(qos->policy<policy::LatencyBudget>()->duration == Duration::zero());
        // the slowest supported IMU gives a sample every 40 ms
        CHECK(qos->policy<policy::Deadline>()->period > milliseconds(40));
      }
      CHECK(provider.datawriter_qos(name).policy<policy::Reliability>()->max_blocking_time <=
            milliseconds(5));
    }
  }
  SECTION("the pose alone is exclusive, on both sides") {
    const auto exclusive = [&](const char* profile) {
      const auto of_writer = provider.datawriter_qos(profile).policy<policy::Ownership>();
      const auto of_reader = provider.datareader_qos(profile).policy<policy::Ownership>();
      CHECK(of_writer.has_value() == of_reader.has_value());
      return of_reader && of_reader->kind == policy::OwnershipKind::exclusive;
    };
    CHECK(exclusive("sonopose::Pose"));
    CHECK(exclusive("sonopose::LosslessPose"));
    for (const char* const name : {"Imu", "Fix", "Heading", "Report", "Status", "Truth", "Command",
                                   "SettingsRequest", "SettingsReply", "Settings"}) {
      CHECK_FALSE(exclusive((std::string("sonopose::") + name).c_str()));
    }
  }
  SECTION(
      "requests and answers on settings: reliable, volatile; what is in force is kept for who comes late") {
    for (const char* const name :
         {"sonopose::SettingsRequest", "sonopose::SettingsReply", "sonopose::Settings"}) {
      for (const Qos* const qos : {&provider.datawriter_qos(name), &provider.datareader_qos(name)}) {
        const bool in_force = std::string(name) == "sonopose::Settings";
        CHECK(qos->policy<policy::Reliability>()->kind == policy::ReliabilityKind::reliable);
        CHECK(qos->policy<policy::Durability>()->kind ==
              (in_force ? policy::DurabilityKind::transient_local : policy::DurabilityKind::volatile_data));
        CHECK(qos->policy<policy::History>()->kind == policy::HistoryKind::keep_last);
        CHECK(qos->policy<policy::History>()->depth == (in_force ? 1 : 64));
        // nobody has to change settings ever again
        const auto deadline = qos->policy<policy::Deadline>();
        CHECK((!deadline || deadline->period == infinite));
      }
    }
    // The fusion writes these where it makes poses.
    for (const char* const name : {"sonopose::SettingsReply", "sonopose::Settings"}) {
      CHECK(provider.datawriter_qos(name).policy<policy::Reliability>()->max_blocking_time <=
            milliseconds(5));
    }
  }
  SECTION("lossless: both sides keep all") {
    for (const char* const name : {"Imu", "Fix", "Heading", "Pose", "Report"}) {
      const std::string profile = std::string("sonopose::Lossless") + name;
      CHECK(provider.datawriter_qos(profile).policy<policy::History>()->kind ==
            policy::HistoryKind::keep_all);
      CHECK(provider.datareader_qos(profile).policy<policy::History>()->kind ==
            policy::HistoryKind::keep_all);
      CHECK(provider.datawriter_qos(profile).policy<policy::Reliability>()->max_blocking_time >=
            milliseconds(100));
    }
  }
}

}  // namespace
}  // namespace sonopose::dds::test
