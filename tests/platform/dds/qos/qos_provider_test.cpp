#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace sonopose::dds::test::qos_provider_test {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

/// A QoS file with `content` from line 4, inside a writer's QoS.
qos::Provider with_writer(const std::string& content) {
  return qos::Provider::from_string(
      "<dds>\n<qos_library name=\"L\">\n<qos_profile name=\"P\"><datawriter_qos>\n" + content +
          "\n</datawriter_qos></qos_profile></qos_library></dds>",
      "file.xml");
}

TEST_CASE("Every policy of a QoS file is read") {
  const qos::Provider provider = with_writer(R"(
    <deadline><period><sec>1</sec><nanosec>500000000</nanosec></period></deadline>
    <latency_budget><duration><nanosec>7</nanosec></duration></latency_budget>
    <lifespan><duration><sec> 3 </sec></duration></lifespan>
    <reliability><kind>RELIABLE_RELIABILITY_QOS</kind>
      <max_blocking_time><sec>0</sec><nanosec>2000000</nanosec></max_blocking_time></reliability>
    <history><kind>KEEP_LAST_HISTORY_QOS</kind><depth>64</depth></history>
    <durability><kind>TRANSIENT_LOCAL_DURABILITY_QOS</kind></durability>
    <durability_service><history_depth>12</history_depth></durability_service>
    <liveliness><kind>MANUAL_BY_TOPIC_LIVELINESS_QOS</kind>
      <lease_duration><sec>DURATION_INFINITE_SEC</sec><nanosec>DURATION_INFINITE_NSEC</nanosec></lease_duration>
    </liveliness>
    <ownership><kind>EXCLUSIVE_OWNERSHIP_QOS</kind></ownership>
    <ownership_strength><value>-5</value></ownership_strength>
    <resource_limits><max_samples>LENGTH_UNLIMITED</max_samples><max_instances>9</max_instances>
      <max_samples_per_instance>64</max_samples_per_instance></resource_limits>
    <transport_priority><value>11</value></transport_priority>
    <writer_data_lifecycle>
      <autodispose_unregistered_instances>false</autodispose_unregistered_instances></writer_data_lifecycle>
    <partition><name><element>a</element><element>b</element></name></partition>
    <user_data><value>AP8Q</value></user_data>)");
  const Qos& qos = provider.datawriter_qos("L::P");
  CHECK(qos.policy<policy::Deadline>()->period() == core::Duration::from_millisecs(1500));
  CHECK(qos.policy<policy::LatencyBudget>()->duration() == core::Duration(0, 7));
  CHECK(qos.policy<policy::Lifespan>()->duration() == core::Duration(3));
  CHECK(qos.policy<policy::Reliability>()->kind() == policy::ReliabilityKind::RELIABLE);
  CHECK(qos.policy<policy::Reliability>()->max_blocking_time() == core::Duration::from_millisecs(2));
  CHECK(qos.policy<policy::History>()->depth() == 64);
  CHECK(qos.policy<policy::DurabilityService>()->history_depth() == 12);
  CHECK(qos.policy<policy::Durability>()->kind() == policy::DurabilityKind::TRANSIENT_LOCAL);
  CHECK(qos.policy<policy::Liveliness>()->kind() == policy::LivelinessKind::MANUAL_BY_TOPIC);
  CHECK(qos.policy<policy::Liveliness>()->lease_duration() == core::Duration::infinite());
  CHECK(qos.policy<policy::Ownership>()->kind() == policy::OwnershipKind::EXCLUSIVE);
  CHECK(qos.policy<policy::OwnershipStrength>()->value() == -5);
  CHECK(qos.policy<policy::ResourceLimits>()->max_samples() == core::LENGTH_UNLIMITED);
  CHECK(qos.policy<policy::ResourceLimits>()->max_instances() == 9);
  CHECK(qos.policy<policy::TransportPriority>()->value() == 11);
  CHECK_FALSE(qos.policy<policy::WriterDataLifecycle>()->autodispose_unregistered_instances());
  CHECK(qos.policy<policy::Partition>()->name() == std::vector<std::string>{"a", "b"});
  CHECK(qos.policy<policy::UserData>()->value() == std::vector<std::uint8_t>{0x00, 0xFF, 0x10});
}

TEST_CASE("Policies that a profile does not set remain unset, and the four kinds of entity are independent") {
  const qos::Provider provider = qos::Provider::from_string(R"(<dds xmlns="http://www.omg.org/dds">
    <qos_library name="L"><qos_profile name="P">
      <datareader_qos><history><kind>KEEP_ALL_HISTORY_QOS</kind></history></datareader_qos>
      <topic_qos><lifespan><duration><sec>1</sec></duration></lifespan></topic_qos>
      <domainparticipant_qos><user_data><value>/w==</value></user_data></domainparticipant_qos>
    </qos_profile></qos_library></dds>)",
                                                            "file.xml");
  CHECK_FALSE(provider.datawriter_qos("L::P").policy<policy::History>());
  CHECK(provider.datareader_qos("L::P").policy<policy::History>()->kind() == policy::HistoryKind::KEEP_ALL);
  CHECK_FALSE(provider.datareader_qos("L::P").policy<policy::Lifespan>());
  CHECK(provider.topic_qos("L::P").policy<policy::Lifespan>()->duration() == core::Duration(1));
  CHECK(provider.participant_qos("L::P").policy<policy::UserData>()->value() ==
        std::vector<std::uint8_t>{0xFF});
}

TEST_CASE("A profile inherits what it does not set itself") {
  const qos::Provider provider = qos::Provider::from_string(R"(<dds>
    <qos_library name="L"><qos_profile name="Base"><datawriter_qos>
      <history><kind>KEEP_LAST_HISTORY_QOS</kind><depth>5</depth></history>
      <transport_priority><value>1</value></transport_priority></datawriter_qos></qos_profile>
      <qos_profile name="Derived" base_name="Base"><datawriter_qos>
      <transport_priority><value>2</value></transport_priority></datawriter_qos></qos_profile></qos_library>
    <qos_library name="M"><qos_profile name="Far" base_name="L::Derived"/></qos_library></dds>)",
                                                            "file.xml");
  for (const char* const profile : {"L::Derived", "M::Far"}) {
    CHECK(provider.datawriter_qos(profile).policy<policy::History>()->depth() == 5);
    CHECK(provider.datawriter_qos(profile).policy<policy::TransportPriority>()->value() == 2);
  }
  CHECK(provider.datawriter_qos("L::Base").policy<policy::TransportPriority>()->value() == 1);
}

TEST_CASE("A missing profile is an error that names file and profile") {
  const qos::Provider provider = with_writer("");
  for (const char* const name : {"P", "L::Q", "M::P", ""}) {
    CHECK_THROWS_WITH(provider.datawriter_qos(name),
                      "file.xml: has no <qos_profile> '" + std::string(name) + "'");
  }
  CHECK_THROWS_AS(provider.topic_qos("L::Q"), qos::FileError);
  CHECK_THROWS_AS(provider.datareader_qos("L::Q"), qos::FileError);
  CHECK_THROWS_AS(provider.participant_qos("L::Q"), qos::FileError);
}

struct Bad {
  const char* content;
  const char* message;  // beginning of what()
};

TEST_CASE("An error in a policy names file, line and element") {
  const std::vector<Bad> cases{
      {"\n<dedline/>", "file.xml:5: <dedline>: unknown element in <datawriter_qos>"},
      {"<time_based_filter/>", "file.xml:4: <time_based_filter>: unknown element"},
      {"\n\n<deadline>\n<perid/></deadline>", "file.xml:7: <perid>: unknown element in <deadline>"},
      {"<deadline unit='s'/>", "file.xml:4: <deadline>: unknown attribute 'unit'"},
      {"<deadline><period><sec x='1'>1</sec></period></deadline>",
       "file.xml:4: <sec>: unknown attribute 'x'"},
      {"<deadline/>", "file.xml:4: <deadline>: <period> is missing"},
      {"<deadline>\n<period/></deadline>", "file.xml:5: <period>: a duration needs"},
      {"<deadline>1</deadline>", "file.xml:4: <deadline>: unexpected text '1'"},
      {"one\n", "file.xml:3: <datawriter_qos>: unexpected text"},
      {"<deadline><period><sec>1s</sec></period></deadline>", "file.xml:4: <sec>: '1s' is no whole number"},
      {"<deadline><period><sec>0.1</sec></period></deadline>", "file.xml:4: <sec>: '0.1' is no whole number"},
      {"<deadline><period><sec></sec></period></deadline>", "file.xml:4: <sec>: a value is missing"},
      {"<deadline><period><sec>-1</sec></period></deadline>", "file.xml:4: <sec>: '-1' is no whole number"},
      {"<deadline><period><sec>2147483648</sec></period></deadline>", "file.xml:4: <sec>: '2147483648'"},
      {"<deadline><period><nanosec>1000000000</nanosec></period></deadline>",
       "file.xml:4: <nanosec>: '1000000000' is no whole number from 0 to 999999999"},
      {"<deadline><period>\n<sec>DURATION_INFINITE_SEC</sec><nanosec>1</nanosec></period></deadline>",
       "file.xml:4: <period>: only one of <sec> and <nanosec> is infinite"},
      {"<deadline><period>\n<sec>0</sec><nanosec>0</nanosec></period></deadline>",
       "file.xml:4: <period>: must be more than zero"},
      {"<lifespan><duration><sec>0</sec></duration></lifespan>",
       "file.xml:4: <duration>: must be more than zero"},
      {"<latency_budget><duration><nanosec>-1</nanosec></duration></latency_budget>",
       "file.xml:4: <nanosec>: '-1'"},
      {"<liveliness><kind>AUTOMATIC_LIVELINESS_QOS</kind>\n<lease_duration><sec>0</sec></lease_duration></"
       "liveliness>",
       "file.xml:5: <lease_duration>: must be more than zero"},
      {"<history>\n<kind>KEEP_LAST</kind><depth>1</depth></history>",
       "file.xml:5: <kind>: 'KEEP_LAST' is not one of KEEP_ALL_HISTORY_QOS, KEEP_LAST_HISTORY_QOS"},
      {"<reliability><kind>reliable</kind></reliability>", "file.xml:4: <kind>: 'reliable' is not one of"},
      {"<reliability/>", "file.xml:4: <reliability>: <kind> is missing"},
      {"<durability><kind>PERSISTENT_DURABILITY_QOS</kind></durability>", "file.xml:4: <kind>: 'PERSISTENT"},
      {"<ownership><kind>MINE</kind></ownership>", "file.xml:4: <kind>: 'MINE' is not one of"},
      {"<history><kind>KEEP_LAST_HISTORY_QOS</kind>\n<depth>0</depth></history>",
       "file.xml:5: <depth>: '0' is no whole number from 1 to 2147483647"},
      {"<history><kind>KEEP_LAST_HISTORY_QOS</kind></history>", "file.xml:4: <history>: <depth> is missing"},
      {"<history><kind>KEEP_ALL_HISTORY_QOS</kind><depth>3</depth></history>",
       "file.xml:4: <depth>: has no meaning"},
      {"<resource_limits><max_samples>0</max_samples></resource_limits>", "file.xml:4: <max_samples>: '0'"},
      {"<history><kind>KEEP_LAST_HISTORY_QOS</kind><depth>9</depth></history>\n"
       "<resource_limits><max_samples_per_instance>8</max_samples_per_instance></resource_limits>",
       "file.xml:3: <datawriter_qos>: the history is deeper than max_samples_per_instance"},
      {"<ownership_strength><value>1</value></ownership_strength>\n"
       "<ownership_strength><value>2</value></ownership_strength>",
       "file.xml:5: <ownership_strength>: occurs twice"},
      {"<deadline><period><sec>1</sec></period>\n<period><sec>2</sec></period></deadline>",
       "file.xml:5: <period>: occurs twice"},
      {"<writer_data_lifecycle><autodispose_unregistered_instances>no</autodispose_unregistered_instances>"
       "</writer_data_lifecycle>",
       "file.xml:4: <autodispose_unregistered_instances>: must be true or false, not 'no'"},
      {"<transport_priority><value>99999999999</value></transport_priority>",
       "file.xml:4: <value>: '99999999999'"},
      {"<partition><name/></partition>", "file.xml:4: <name>: <element> is missing"},
      {"<partition><name><elem>a</elem></name></partition>", "file.xml:4: <elem>: unknown element in <name>"},
      {"<user_data><value>AB</value></user_data>", "file.xml:4: <value>: is not base64"},
      {"<user_data><value>A?==</value></user_data>", "file.xml:4: <value>: is not base64"},
      {"<deadline><period><sec><b>1</b></sec></period></deadline>", "file.xml:4: <b>: unknown element"},
      {"\n<deadline>\n</dedline>", "file.xml:6: not well-formed XML"},
  };
  for (const Bad& bad : cases) {
    CAPTURE(bad.content);
    CHECK_THROWS_AS(with_writer(bad.content), qos::FileError);
    CHECK_THROWS_WITH(with_writer(bad.content), Catch::StartsWith(bad.message));
  }
}

TEST_CASE("An error in the structure of a file names file, line and element") {
  const std::vector<Bad> cases{
      {"", "file.xml:1: not well-formed XML"},
      {"<dds/>", "file.xml: contains no <qos_profile>"},
      {"<ddx/>", "file.xml:1: <ddx>: unknown element"},
      {"<dds>\n<types/></dds>", "file.xml:2: <types>: unknown element in <dds>"},
      {"<dds version='1'/>", "file.xml:1: <dds>: unknown attribute 'version'"},
      {"<dds><qos_library/></dds>", "file.xml:1: <qos_library>: attribute 'name' is missing"},
      {"<dds><qos_library name='a::b'/></dds>", "file.xml:1: <qos_library>: 'a::b' contains '::'"},
      {"<dds><qos_library name='L'/>\n<qos_library name='L'/></dds>",
       "file.xml:2: <qos_library>: 'L' occurs twice"},
      {"<dds><qos_library name='L'>\n<profile/></qos_library></dds>",
       "file.xml:2: <profile>: unknown element"},
      {"<dds><qos_library name='L'><qos_profile/></qos_library></dds>",
       "file.xml:1: <qos_profile>: attribute 'name' is missing"},
      {"<dds><qos_library name='L'><qos_profile name='P'/>\n\n<qos_profile name='P'/></qos_library></dds>",
       "file.xml:3: <qos_profile>: 'L::P' occurs twice"},
      {"<dds><qos_library name='L'><qos_profile name='P' base='Q'/></qos_library></dds>",
       "file.xml:1: <qos_profile>: unknown attribute 'base'"},
      {"<dds><qos_library name='L'>\n<qos_profile name='P' base_name='Q'/></qos_library></dds>",
       "file.xml:2: <qos_profile>: no profile 'L::Q' precedes it"},
      {"<dds><qos_library name='L'><qos_profile name='P' base_name='P'/></qos_library></dds>",
       "file.xml:1: <qos_profile>: no profile 'L::P' precedes it"},
      {"<dds><qos_library name='L'><qos_profile "
       "name='P'>\n<publisher_qos/></qos_profile></qos_library></dds>",
       "file.xml:2: <publisher_qos>: unknown element in <qos_profile>"},
      {"<dds><qos_library name='L'><qos_profile "
       "name='P'><topic_qos/>\n<topic_qos/></qos_profile></qos_library></dds>",
       "file.xml:2: <topic_qos>: occurs twice"},
      {"<dds><qos_library name='L'><qos_profile name='P'><datareader_qos>\n<lifespan/>"
       "</datareader_qos></qos_profile></qos_library></dds>",
       "file.xml:2: <lifespan>: unknown element in <datareader_qos>"},
      {"<dds><qos_library name='L'><qos_profile name='P'><domainparticipant_qos>\n<deadline/>"
       "</domainparticipant_qos></qos_profile></qos_library></dds>",
       "file.xml:2: <deadline>: unknown element in <domainparticipant_qos>"},
  };
  for (const Bad& bad : cases) {
    CAPTURE(bad.content);
    CHECK_THROWS_WITH(qos::Provider::from_string(bad.content, "file.xml"), Catch::StartsWith(bad.message));
  }
}

}  // namespace sonopose::dds::test::qos_provider_test
