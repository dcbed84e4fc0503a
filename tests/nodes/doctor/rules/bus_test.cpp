#include "doctor/rules/healthy_system.hpp"
#include "doctor/rules/report.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace sonopose::bus_test {

using namespace sonopose::doctor::rules;
using namespace sonopose::doctor::rules::test;
using Catch::Contains;

TEST_CASE("A healthy system has no problems") {
  for (const Finding& finding : diagnose(healthy())) {
    CAPTURE(finding.what);
    CHECK(finding.severity == Severity::ok);
  }
  CHECK_FALSE(has_problems(diagnose(healthy())));
}

TEST_CASE("An empty domain is an error, and the remedy names the domain that is in use") {
  Observations observations = healthy();
  observations.writers.clear();
  observations.readers.clear();
  observations.beacons.clear();
  observations.bus.searched_other_domains = true;
  CHECK(found(diagnose(observations), "no sonopose process in domain 5").severity == Severity::error);
  CHECK_THAT(found(diagnose(observations), "no sonopose process").what,
             Contains("nor in the other domains checked"));
  CHECK_THAT(found(diagnose(observations), "no sonopose process").remedy, Contains("--network lan"));
  CHECK_THAT(found(diagnose(observations), "no sonopose process").what, !Contains("could not be checked"));
  observations.bus.domains_not_searched = 40;
  CHECK_THAT(found(diagnose(observations), "no sonopose process").what,
             Contains("40 other domains could not be checked"));
  observations.bus.other_domains = {{.id = 8, .beacons = true, .poses = false, .ours = true}};
  CHECK(found(diagnose(observations), "no sonopose process").remedy ==
        "beacons are published in domain 8: use --domain 8");
}

TEST_CASE("A domain whose processes show no topics may be secured") {
  Observations observations = healthy();
  observations.writers.clear();
  observations.readers.clear();
  observations.bus.without_topics = 2;
  const auto findings = diagnose(observations);
  CHECK_THAT(found(findings, "2 processes in domain 5 show no topics").remedy, Contains("--security"));
  CHECK(found(findings, "no sonopose process").what.empty());
  observations.bus.is_secured = true;
  CHECK_FALSE(found(diagnose(observations), "no sonopose process").what.empty());
}

TEST_CASE("A system on loopback beside an empty network is named") {
  Observations observations = healthy();
  observations.writers.clear();
  observations.readers.clear();
  observations.bus.other_domains = {{.id = 5, .beacons = true, .ours = true, .on_loopback = true}};
  CHECK(found(diagnose(observations), "no sonopose process").remedy ==
        "beacons are published on loopback of this machine: use --network loopback");
}

TEST_CASE("A system on a network without security is a note, which is no failure") {
  Observations observations = healthy();
  observations.bus.loopback_only = false;
  CHECK(found(diagnose(observations), "no security").severity == Severity::note);
  CHECK_FALSE(has_problems(diagnose(observations)));
  CHECK_THAT(found(diagnose(observations), "no security").remedy, Contains("--security"));
  observations.bus.is_secured = true;
  CHECK_FALSE(has_problems(diagnose(observations)));
  observations.bus.refused = {"sonopose-monitor (process 812 on rover): it has no certificate",
                              "sonopose-web (process 813 on rover): its permissions have expired"};
  observations.bus.expiring = {"enclave fusion expires in 12 days, at 2026-12-11T00:00:00"};
  const auto findings = diagnose(observations);
  CHECK_THAT(found(findings, "DDS Security refused sonopose-monitor").what, Contains("no certificate"));
  CHECK_THAT(found(findings, "refused sonopose-monitor").remedy, Contains("--security"));
  CHECK_THAT(found(findings, "refused sonopose-web").remedy, Contains("sonopose-security check"));
  CHECK_THAT(found(findings, "enclave fusion expires").remedy, Contains("sonopose-security renew"));
}

TEST_CASE("A missing network is an error with the interfaces there are") {
  Observations observations = healthy();
  observations.bus.is_network_missing = true;
  observations.bus.interfaces_in_use = "no network interface is up with an IPv4 address, only lo (127.0.0.1)";
  observations.bus.loopback_only = true;
  observations.writers.clear();
  const auto findings = diagnose(observations);
  CHECK(found(findings, "no network interface is up with an IPv4 address, only lo").severity ==
        Severity::error);
  CHECK(found(findings, "domain 5, this machine only").what.empty());
  CHECK_THAT(found(findings, "no sonopose process").remedy, !Contains("--network lan"));
}

TEST_CASE("Processes of other systems are ignored") {
  Observations observations = healthy();
  observations.writers = {endpoint("rt/chatter", "std_msgs::msg::dds_::String_", "talker")};
  observations.readers.clear();
  CHECK(found(diagnose(observations), "no sonopose process").severity == Severity::error);
}

TEST_CASE("More beacons than the doctor looks at are a problem") {
  Observations observations = healthy();
  observations.beacons_refused = "44 addresses are ignored";
  CHECK(found(diagnose(observations), "44 addresses are ignored").severity == Severity::warning);
}

TEST_CASE("Fusions and lines beyond the limits are a problem, and how many") {
  Observations observations = healthy();
  observations.not_observed = {"3 fusions were not observed", "1 line was not observed"};
  const auto findings = diagnose(observations);
  CHECK(found(findings, "3 fusions were not observed").severity == Severity::warning);
  CHECK(found(findings, "1 line was not observed").severity == Severity::warning);
}

TEST_CASE("A missing bridge, a missing fusion and missing subscribers are distinguished") {
  SECTION("no bridge") {
    Observations observations = healthy();
    observations.writers.erase(observations.writers.begin());
    CHECK(found(diagnose(observations), "no bridge publishes").severity == Severity::error);
    CHECK_THAT(found(diagnose(observations), "no bridge publishes").remedy,
               Contains("sonopose-bridge --domain 5"));
    // Consequences of the missing bridge are not reported.
    CHECK(found(diagnose(observations), "no IMU sample").severity == Severity::ok);
  }
  SECTION("no fusion") {
    Observations observations = healthy();
    observations.writers.pop_back();
    observations.beacons.front().pose = {};
    CHECK(found(diagnose(observations), "no fusion runs").severity == Severity::error);
    CHECK(found(diagnose(observations), "no pose of this beacon").severity == Severity::ok);
  }
  SECTION("no subscriber") {
    Observations observations = healthy();
    observations.readers.pop_back();
    CHECK(found(diagnose(observations), "no process subscribes to the poses").severity == Severity::note);
    CHECK_FALSE(has_problems(diagnose(observations)));
  }
}

TEST_CASE("A bridge and a fusion in different domains must come into one") {
  Observations observations = healthy();
  observations.bus.searched_other_domains = true;
  observations.bus.other_domains = {{.id = 8, .ours = true}, {.id = 9, .poses = true, .ours = true}};
  SECTION("the fusion is elsewhere") {
    observations.writers.pop_back();
    CHECK(found(diagnose(observations), "no fusion runs").remedy ==
          "a fusion runs in domain 9: start both bridge and fusion with the same --domain");
  }
  SECTION("the bridge is elsewhere") {
    observations.bus.other_domains.front().beacons = true;
    observations.writers.erase(observations.writers.begin());
    CHECK(found(diagnose(observations), "no bridge publishes").remedy ==
          "beacons are published in domain 8: start both bridge and fusion with the same --domain");
  }
  SECTION("no domain has a bridge") {
    observations.writers.erase(observations.writers.begin());
    CHECK_THAT(found(diagnose(observations), "no bridge publishes").remedy,
               Contains("start sonopose-bridge --domain 5"));
  }
}

TEST_CASE("A look that was stopped, and fits that were not made, are notes") {
  Observations observations = healthy();
  CHECK(found(diagnose(observations), "stopped after").what.empty());
  observations.window_s = 1.2;
  observations.cut_from_s = 8.0;
  observations.beacons_not_fitted = 3;
  CHECK(found(diagnose(observations), "stopped after 1.2 s of 8 s").severity == Severity::note);
  CHECK(found(diagnose(observations), "signs of 3 beacons were not checked").severity == Severity::note);
}

TEST_CASE("An interface without multicast needs peers") {
  Observations observations = healthy();
  observations.bus.interfaces = {{"lo", false, true}};
  CHECK(found(diagnose(observations), "lo, which has no multicast").severity == Severity::note);
  observations.bus.interfaces = {{"wlan0", false, false}};
  CHECK(found(diagnose(observations), "wlan0, which has no multicast").severity == Severity::warning);
  CHECK_THAT(found(diagnose(observations), "wlan0").remedy, Contains("<Peers>"));
  observations.bus.has_peers = true;
  CHECK_FALSE(has_problems(diagnose(observations)));
  observations.bus.has_peers = false;
  observations.bus.interfaces = {{"eth0", true, false}};
  CHECK_FALSE(has_problems(diagnose(observations)));
}

TEST_CASE("A reader that does not match is reported with the policy and its process") {
  Observations observations = healthy();
  observations.readers.push_back(
      endpoint("sonopose/pose", "sonopose::FusedPose", "planner"));  // shared ownership
  const Finding finding =
      found(diagnose(observations), "planner (process 100 on rover) cannot receive from sonopose-fusion");
  CHECK(finding.severity == Severity::error);
  CHECK(finding.subject == "sonopose/pose");
  CHECK_THAT(finding.what, Contains("ownership: offered exclusive, requested shared"));
  CHECK_THAT(finding.remedy, Contains("exclusive"));
}

TEST_CASE("A deadline that is too short is an error of its topic") {
  Observations observations = healthy();
  observations.readers.front().qos << dds::policy::Deadline(
      dds::ext::to_duration(std::chrono::milliseconds(1)));
  CHECK(found(diagnose(observations), "deadline: offered infinite, requested 1 ms").subject ==
        "sonopose/imu");
}

TEST_CASE("If the fusion does not receive the beacon, consequences are not reported") {
  Observations observations = healthy();
  observations.readers.front().qos << dds::policy::Deadline(
      dds::ext::to_duration(std::chrono::milliseconds(1)));
  observations.beacons.front().pose = {};
  observations.beacons.front().fusion->events_lost = 100;
  const auto findings = diagnose(observations);
  CHECK(std::count_if(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.severity >= Severity::warning; }) == 1);
}

TEST_CASE("The same topic with another type is an error") {
  Observations observations = healthy();
  observations.readers.push_back(endpoint("sonopose/imu", "other::Imu", "logger"));
  const Finding finding =
      found(diagnose(observations), "logger (process 100 on rover) reads it as type other::Imu");
  CHECK(finding.severity == Severity::error);
  CHECK_THAT(finding.remedy, Contains("sonopose.idl"));
}

TEST_CASE("Two fusions with the same strength are a warning with their names, a weaker one is on standby") {
  Observations observations = healthy();
  FusionStatus fusion;
  fusion.fusion_id = 1;
  fusion.role = FusionRole::serving;
  fusion.strength = 100;
  observations.beacons.front().fusion = fusion;
  observations.beacons.front().fusions = {fusion, fusion};
  observations.pose_writers = {{"a", {"fusion-a", "rover", 1}, exclusive(100), true, {7}},
                               {"b", {"fusion-b", "rover", 2}, exclusive(100), true, {7}}};
  const Finding finding = found(diagnose(observations), "with the same strength 100");
  CHECK(finding.severity == Severity::warning);
  CHECK_THAT(finding.what, Contains("fusion-a (process 1 on rover) and fusion-b (process 2 on rover)"));
  observations.pose_writers.back().qos = exclusive(50);
  CHECK_FALSE(has_problems(diagnose(observations)));
  CHECK_THAT(found(diagnose(observations), "on standby").what, Contains("strength 100"));
}

TEST_CASE("A process that writes poses and is no fusion is an error with its name") {
  Observations observations = healthy();
  observations.pose_writers = {{"a", {"intruder", "laptop", 3}, exclusive(1000), false, {}}};
  const Finding finding = found(diagnose(observations), "is no fusion");
  CHECK(finding.severity == Severity::error);
  CHECK_THAT(finding.what, Contains("intruder (process 3 on laptop) writes poses with strength 1000"));
}

TEST_CASE(
    "Endpoints in different partitions are not a problem; a bridge without a fusion in its partition is a "
    "warning") {
  Observations observations = healthy();
  const dds::Qos east = dds::Qos() << dds::policy::Partition("east");
  observations.writers.push_back(endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-bridge", east));
  CHECK(found(diagnose(observations), "no reader is in the partition of sonopose-bridge").severity ==
        Severity::warning);
  observations.readers.push_back(endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-fusion", east));
  CHECK_FALSE(has_problems(diagnose(observations)));
}

TEST_CASE("A reader that matches none of the two pose writers of a standby is one problem") {
  Observations observations = healthy();
  observations.writers.back().qos = exclusive(200);
  observations.writers.push_back(
      endpoint("sonopose/pose", "sonopose::FusedPose", "sonopose-fusion", exclusive(0)));
  observations.readers.push_back(endpoint("sonopose/pose", "sonopose::FusedPose", "shared"));
  const auto findings = diagnose(observations);
  CHECK(std::count_if(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.severity == Severity::error; }) == 1);
  CHECK_THAT(found(findings, "shared (process 100 on rover) cannot receive from sonopose-fusion").what,
             Contains("ownership"));
}

TEST_CASE("The report has the most severe finding last, the remedies, and a count") {
  const std::vector<Finding> findings{{Severity::error, "beacon 7", "it burns", "pour water"},
                                      {Severity::ok, "bus", "fine", ""},
                                      {Severity::warning, "beacon 8", "it smokes", "look"}};
  const std::string text = report_of(findings);
  CHECK(text ==
        "ok       bus: fine\n"
        "warning  beacon 8: it smokes\n"
        "         → look\n"
        "error    beacon 7: it burns\n"
        "         → pour water\n"
        "1 error, 1 warning\n");
  CHECK_THAT(report_of({findings[1]}), Contains("no problems found"));

  const auto json = nlohmann::json::parse(json_of(findings));
  CHECK(json["ok"] == false);
  CHECK(json["findings"].size() == 3);
  CHECK(json["findings"][0]["severity"] == "error");
  CHECK(json["findings"][0]["remedy"] == "pour water");
  CHECK(nlohmann::json::parse(json_of({findings[1]}))["ok"] == true);

  const std::vector<Finding> of_bus{{Severity::warning, "process \xff", "runs", ""}};  // not UTF-8
  CHECK(nlohmann::json::parse(json_of(of_bus))["findings"][0]["subject"] == R"(process \xff)");
}

TEST_CASE("A process is named by its known fields") {
  CHECK(text_of(ProcessObservation{"a", "h", 3}) == "a (process 3 on h)");
  CHECK(text_of(ProcessObservation{"a", "", 3}) == "a (process 3)");
  CHECK(text_of(ProcessObservation{"", "h", {}}) == "a process (on h)");
  CHECK(text_of(ProcessObservation{}) == "an unknown process");
}

}  // namespace sonopose::bus_test
