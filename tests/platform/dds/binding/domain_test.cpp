#include "dds/dds_fixture.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <catch2/catch.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <unistd.h>

namespace sonopose::dds::test::domain_test {

namespace fs = std::filesystem;

TEST_CASE("The domain is the option's, else ROS_DOMAIN_ID, else 0") {
  const Environment nothing("ROS_DOMAIN_ID", nullptr);
  CHECK(resolve_domain_id({}) == 0);
  {
    const Environment empty("ROS_DOMAIN_ID", "");
    CHECK(resolve_domain_id({}) == 0);
  }
  const Environment environment("ROS_DOMAIN_ID", "42");
  CHECK(resolve_domain_id({}) == 42);
  CHECK(resolve_domain_id({.domain_id = 7}) == 7);
  CHECK(resolve_domain_id({.domain_id = 232}) == 232);
}

TEST_CASE("Only the word Permissive lets a process without its enclave join without security") {
  const Environment key_store("ROS_SECURITY_KEYSTORE", "/nonexistent/keys");
  const Environment enable("ROS_SECURITY_ENABLE", "true");
  const Environment override("ROS_SECURITY_ENCLAVE_OVERRIDE", nullptr);
  for (const char* const refusing : {static_cast<const char*>(nullptr), "Enforce", "permissive"}) {
    const Environment strategy("ROS_SECURITY_STRATEGY", refusing);
    CHECK(enclave_by_environment("fusoin") == "/nonexistent/keys/enclaves/fusoin");
    CHECK_THROWS_AS(participant(), core::Exception);
  }
  const Environment strategy("ROS_SECURITY_STRATEGY", "Permissive");
  CHECK(enclave_by_environment("fusoin").empty());
}

TEST_CASE("ROS_SECURITY_ENABLE is true or false, in upper or lower case, and no other word") {
  const Environment key_store("ROS_SECURITY_KEYSTORE", "/nonexistent/keys");
  const Environment strategy("ROS_SECURITY_STRATEGY", nullptr);
  for (const char* const value : {"true", "True", "TRUE"}) {
    const Environment enable("ROS_SECURITY_ENABLE", value);
    CHECK(enclave_by_environment("fusion") == "/nonexistent/keys/enclaves/fusion");
  }
  for (const char* const value : {"false", "False", ""}) {
    const Environment enable("ROS_SECURITY_ENABLE", value);
    CHECK(enclave_by_environment("fusion").empty());
  }
  const Environment enable("ROS_SECURITY_ENABLE", "1");
  CHECK_THROWS_WITH(enclave_by_environment("fusion"), Catch::Contains("ROS_SECURITY_ENABLE is '1'"));
}

TEST_CASE("An invalid domain is rejected with its name and value") {
  for (const char* const value : {"233", "-1", "x", "4x", " 4", "4.0", "99999999999"}) {
    const Environment environment("ROS_DOMAIN_ID", value);
    CHECK_THROWS_AS(resolve_domain_id({}), std::invalid_argument);
    CHECK_THROWS_WITH(
        resolve_domain_id({}),
        Catch::StartsWith("ROS_DOMAIN_ID is '" + std::string(value) + "'") && Catch::Contains("0 to 232"));
    CHECK(resolve_domain_id({.domain_id = 7}) == 7);
  }
  CHECK_THROWS_WITH(resolve_domain_id({.domain_id = 233}), Catch::Contains("'233'"));
}

TEST_CASE("The highest domain can be joined: its ports end at 65535") {
  CHECK_NOTHROW(ext::participant({.domain_id = max_domain_id}));
}

TEST_CASE("Participants of one process share its domain") {
  const auto first = std::make_unique<domain::DomainParticipant>(participant());
  auto second = std::make_unique<domain::DomainParticipant>(participant());
  CHECK_THROWS_WITH(ext::participant({.domain_id = test_domain(), .network = Network::lan}),
                    Catch::Contains("domain " + std::to_string(test_domain())));

  const topic::Topic<sonopose_ResetCommand> in(*first, "test/shared");
  sub::DataReader<sonopose_ResetCommand> reader(sub::Subscriber(*first), in,
                                                Qos() << policy::Reliability::Reliable());
  {
    const topic::Topic<sonopose_ResetCommand> out(*second, "test/shared");
    pub::DataWriter<sonopose_ResetCommand> writer(pub::Publisher(*second), out);
    REQUIRE(matched(reader));
    writer.write(command(7, 1));
  }
  second.reset();
  CHECK(take_samples(reader, 1).at(0).request_id == 1);
}

/// Configuration that Cyclone DDS logs when this process joins under the given CYCLONEDDS_URI.
std::string effective_configuration(const std::string& user_uri, Network network) {
  const fs::path log = fs::temp_directory_path() / ("sonopose_trace_" + std::to_string(getpid()));
  fs::remove(log);
  const std::string uri = (user_uri.empty() ? "" : user_uri + ",") +
                          "<CycloneDDS><Domain><Tracing><Verbosity>config</Verbosity><OutputFile>" +
                          log.string() + "</OutputFile></Tracing></Domain></CycloneDDS>";
  {
    const Environment environment("CYCLONEDDS_URI", uri.c_str());
    const domain::DomainParticipant member =
        ext::participant({.domain_id = test_domain(), .network = network});
  }
  std::ostringstream text;
  text << std::ifstream(log).rdbuf();
  fs::remove(log);
  return text.str();
}

TEST_CASE("The user's CYCLONEDDS_URI takes precedence, except for the single receive thread") {
  using Catch::Contains;
  const std::string one_thread = "Internal/MultipleReceiveThreads/#text: false";
  const std::string lo = "NetworkInterface[@name]: lo";
  const std::string self = "Peer[@Address]: 127.0.0.1";

  SECTION("without one: loopback, no multicast, peers by port") {
    const std::string effective = effective_configuration("", Network::loopback);
    CHECK_THAT(effective, Contains(lo) && Contains(self) && Contains(one_thread));
    CHECK_THAT(effective, Contains("selected interfaces: lo (") && Contains("AllowMulticast/#text: false"));
    CHECK_THAT(effective, Contains("Discovery/ParticipantIndex/#text: auto"));
    CHECK_THAT(effective, Contains("MaxAutoParticipantIndex/#text: 119"));
  }
  SECTION("a lost packet is asked for long before a lease of 100 ms expires") {
    CHECK_THAT(effective_configuration("", Network::loopback), Contains("NackDelay/#text: 10 ms"));
  }
  SECTION("lan: Cyclone DDS chooses, and local processes are still found") {
    const std::string effective = effective_configuration("", Network::lan);
    CHECK_THAT(effective, !Contains(lo) && Contains(self) && Contains(one_thread));
    CHECK_THAT(effective, !Contains("AllowMulticast/#text: false"));
  }
  SECTION("for ROS 2: always loopback, and one more interface if there is one") {
    for (const Network network : {Network::ros_localhost, Network::ros_subnet}) {
      const std::string effective = effective_configuration("", network);
      CHECK_THAT(effective, Contains(lo) && Contains(self) && Contains(one_thread));
      CHECK_THAT(effective, Contains("selected interfaces: lo ("));
    }
    CHECK_THAT(effective_configuration("", Network::ros_localhost), Contains("AllowMulticast/#text: false"));
  }
  SECTION("single values of the user's replace ours; the receive thread does not") {
    const std::string effective = effective_configuration(
        "<CycloneDDS><Domain><Discovery><MaxAutoParticipantIndex>33</MaxAutoParticipantIndex></Discovery>"
        "<Internal><MultipleReceiveThreads>true</MultipleReceiveThreads></Internal></Domain></CycloneDDS>",
        Network::loopback);
    CHECK_THAT(effective, Contains("MaxAutoParticipantIndex/#text: 33") && Contains(one_thread));
    CHECK_THAT(effective, Contains(lo) && Contains(self));
  }
  SECTION("peers of the user's replace ours") {
    const std::string effective = effective_configuration(
        R"(<cyclonedds><domain id="any"><discovery><peers><peer address="127.0.0.2"/></peers>)"
        "</discovery></domain></cyclonedds>",
        Network::loopback);
    CHECK_THAT(effective, Contains("127.0.0.2") && !Contains(self) && Contains(lo));
  }
  SECTION("interfaces of the user's replace ours, from a file") {
    const fs::path file = fs::temp_directory_path() / ("sonopose_uri_" + std::to_string(getpid()) + ".xml");
    std::ofstream(file)
        << R"(<?xml version="1.0"?><CycloneDDS><Domain><General><Interfaces>)"
        << R"(<NetworkInterface address="127.0.0.1"/></Interfaces></General></Domain></CycloneDDS>)";
    for (const std::string prefix : {"file://", ""}) {
      const std::string effective = effective_configuration(prefix + file.string(), Network::loopback);
      CHECK_THAT(effective, Contains("NetworkInterface[@address]: 127.0.0.1") && !Contains(lo));
    }
    fs::remove(file);
  }
  SECTION("settings of another domain do not change ours") {
    const std::string other = std::to_string(test_domain() + 1);
    const std::string effective = effective_configuration(
        "<CycloneDDS><Domain id=\"" + other +
            R"("><General><Interfaces><NetworkInterface name="nowhere"/></Interfaces></General></Domain></CycloneDDS>)",
        Network::loopback);
    CHECK_THAT(effective, Contains(lo) && !Contains("nowhere"));
  }
  SECTION("an invalid one is an error that names it") {
    const Environment environment("CYCLONEDDS_URI", "<CycloneDDS><Domain><Nonsense/></Domain></CycloneDDS>");
    for (int attempt = 0; attempt < 2; ++attempt) {  // the failure leaves no trace
      CHECK_THROWS_WITH(participant(),
                        Contains("dds_create_domain") && Contains("CYCLONEDDS_URI") && Contains("Nonsense"));
    }
  }
}

TEST_CASE("An error of a domain has the reason that Cyclone DDS logs, and the interfaces there are") {
  using Catch::Contains;
  const Environment environment("CYCLONEDDS_URI",
                                R"(<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="wlan7"/>)"
                                "</Interfaces></General></Domain></CycloneDDS>");
  CHECK_THROWS_WITH(participant(), Contains("CYCLONEDDS_URI") && Contains("wlan7: does not match") &&
                                       Contains("lo (127.0.0.1)"));
}

TEST_CASE("Shared memory without its daemon is refused at once, with what to do") {
  using Catch::Contains;
  if (fs::exists("/tmp/roudi")) {
    std::cout << "skipped: iox-roudi runs, or has left /tmp/roudi; stop it\n";
    return;
  }
  const auto uri = [](const std::string& enable) {
    return "<CycloneDDS><Domain><SharedMemory><Enable>" + enable +
           "</Enable></SharedMemory></Domain></CycloneDDS>";
  };
  const Environment environment("CYCLONEDDS_URI", uri(" true ").c_str());
  CHECK_THROWS_WITH(participant(), Contains("CYCLONEDDS_URI enables shared memory") &&
                                       Contains("iox-roudi") && Contains("SharedMemory/Enable"));
  CHECK_FALSE(network_named_by(uri("false"), 5).shared_memory);
}

TEST_CASE("Peers of the options are searched in addition to this machine") {
  using Catch::Contains;
  const auto configured = [](const DomainOptions& options, const char* uri = "") {
    return domain_configuration(0, options, uri);
  };
  const std::string self = R"(<Peer address="127.0.0.1"/>)";
  const std::string robot = R"(<Peer address="robot"/>)";
  CHECK_THAT(configured({.peers = {"robot"}}), Contains(self + robot));
  CHECK_THAT(configured({.peers = {"robot"}},
                        "<CycloneDDS><Domain><Discovery><Peers/></Discovery></Domain></CycloneDDS>"),
             Contains("<Peers>" + robot) && !Contains(self));
  for (const char* const peer : {"", "a b", "a\"/>", "<a>"}) {
    CHECK_THROWS_WITH(configured({.peers = {peer}}), Contains(std::string("peer '") + peer + "'"));
  }
  const domain::DomainParticipant member = participant();
  CHECK_THROWS_AS(ext::participant({.domain_id = test_domain(), .peers = {"127.0.0.2"}}), core::Exception);
}

TEST_CASE("The variables that are set are found, the empty ones are not") {
  const Environment set("SONOPOSE_TEST_SET", "x");
  const Environment empty("SONOPOSE_TEST_EMPTY", "");
  CHECK(environment_variables({"SONOPOSE_TEST_SET", "SONOPOSE_TEST_EMPTY", "SONOPOSE_TEST_UNSET"}) ==
        std::map<std::string, std::string>{{"SONOPOSE_TEST_SET", "x"}});
}

TEST_CASE("The network settings of CYCLONEDDS_URI are read as Cyclone DDS reads them") {
  const auto in_domain = [](const char* attributes, const std::string& content) {
    return "<CycloneDDS><Domain" + std::string(attributes) + ">" + content + "</Domain></CycloneDDS>";
  };
  const std::string named = R"(<General><Interfaces><NetworkInterface name="eth0"/>)"
                            R"(<NetworkInterface address="10.0.0.2"/></Interfaces>)"
                            R"(<AllowMulticast>false</AllowMulticast></General>)";
  const UserNetwork network = network_named_by(in_domain("", named), 5);
  CHECK(network.interfaces == std::vector<std::string>{"eth0", "10.0.0.2"});
  CHECK(network.without_multicast);
  CHECK_FALSE(network.peers);

  CHECK(network_named_by(in_domain(R"( id="6")", named), 5).interfaces.empty());
  CHECK(network_named_by(in_domain("", "<Discovery><Peers/></Discovery>"), 5).peers);
  CHECK(network_named_by("", 5).interfaces.empty());
  CHECK_FALSE(network_named_by("nonsense", 5).without_multicast);
  const std::string ipv6 = "<General><Transport>udp6</Transport><UseIPv6>default</UseIPv6></General>";
  CHECK(network_named_by(in_domain("", ipv6), 5).other_transport);
  std::string deep;
  for (int i = 0; i < 200'000; ++i) deep += "<a>";  // would overflow the stack without a limit
  CHECK_FALSE(network_named_by(deep, 5).peers);
}

/// Another process that writes until this object is destroyed.
class Peer {
public:
  explicit Peer(const std::string& network)
      : input_(popen(
            (std::string(SONOPOSE_TEST_DDS_PEER) + " " + std::to_string(test_domain()) + " " + network + " 7")
                .c_str(),
            "w")) {}
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  ~Peer() { stop(); }

  /// Ends the process and returns its exit code.
  int stop() {
    if (input_ == nullptr) return -1;
    const int code = pclose(input_);
    input_ = nullptr;
    return code;
  }

private:
  FILE* input_;
};

TEST_CASE("Two processes find each other on one machine") {
  const std::string name = GENERATE("loopback", "lan");
  GIVEN("a reader here and a writer in another process, " + name) {
    const domain::DomainParticipant member = ext::participant(
        {.domain_id = test_domain(), .network = name == "lan" ? Network::lan : Network::loopback});
    const topic::Topic<sonopose_ResetCommand> topic(member, "test/peer");
    sub::DataReader<sonopose_ResetCommand> reader(
        sub::Subscriber(member), topic,
        Qos() << policy::Reliability::Reliable() << policy::History::KeepAll());
    Peer peer(name);
    WHEN("the writer writes") {
      const auto samples = take_samples(reader, 5);
      THEN("its samples come without a gap") {
        REQUIRE(samples.size() >= 5);
        for (std::size_t i = 1; i < samples.size(); ++i) {
          CHECK(samples[i].request_id == samples[i - 1].request_id + 1);
        }
        CHECK(peer.stop() == 0);
        CHECK(matched(reader, 0));
      }
    }
  }
}

TEST_CASE("A process joins a domain with many others") {
  const domain::DomainParticipant member = participant();
  const topic::Topic<sonopose_ResetCommand> topic(member, "test/peer");
  sub::DataReader<sonopose_ResetCommand> reader(
      sub::Subscriber(member), topic,
      Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(1));
  // Cyclone DDS's default finds ten participants per machine.
  std::vector<std::unique_ptr<Peer>> peers(14);
  for (auto& peer : peers) peer = std::make_unique<Peer>("loopback");
  CHECK(matched(reader, 14));
}

}  // namespace sonopose::dds::test::domain_test
