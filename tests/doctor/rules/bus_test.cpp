#include "doctor/rules/doctor_support.hpp"
#include "doctor/rules/report.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace sonopose;
using namespace sonopose::doctor;
using namespace sonopose::doctor::test;
using Catch::Contains;

TEST_CASE("Of a healthy system nothing is wrong") {
  for (const Finding& finding : diagnose(healthy())) {
    CAPTURE(finding.what);
    CHECK(finding.severity == Severity::ok);
  }
  CHECK_FALSE(any_wrong(diagnose(healthy())));
}

TEST_CASE("Nobody in the domain is an error, and where they are instead is told") {
  Observations seen = healthy();
  seen.writers.clear();
  seen.readers.clear();
  seen.beacons.clear();
  seen.bus.looked_elsewhere = true;
  CHECK(found(diagnose(seen), "no sonopose process in domain 5").severity == Severity::error);
  CHECK_THAT(found(diagnose(seen), "no sonopose process").what, Contains("nor in the others"));
  CHECK_THAT(found(diagnose(seen), "no sonopose process").remedy, Contains("--network lan"));
  seen.bus.other_domains = {{.id = 8, .beacons = true, .poses = false, .ours = true}};
  CHECK(found(diagnose(seen), "no sonopose process").remedy ==
        "beacons are published in domain 8: use --domain 8");
}

TEST_CASE("A process of another system in the domain is nobody") {
  Observations seen = healthy();
  seen.writers = {endpoint("rt/chatter", "std_msgs::msg::dds_::String_", "talker")};
  seen.readers.clear();
  CHECK(found(diagnose(seen), "no sonopose process").severity == Severity::error);
}

TEST_CASE("A missing bridge, a missing fusion and missing listeners are told apart") {
  SECTION("no bridge") {
    Observations seen = healthy();
    seen.writers.erase(seen.writers.begin());
    CHECK(found(diagnose(seen), "nobody publishes beacons").severity == Severity::error);
    CHECK_THAT(found(diagnose(seen), "nobody publishes beacons").remedy,
               Contains("sonopose-bridge --domain 5"));
    // What follows from it is not told as well.
    CHECK(found(diagnose(seen), "no IMU sample").severity == Severity::ok);
  }
  SECTION("no fusion") {
    Observations seen = healthy();
    seen.writers.pop_back();
    seen.beacons.front().pose = {};
    CHECK(found(diagnose(seen), "no fusion runs").severity == Severity::error);
    CHECK(found(diagnose(seen), "no pose of this beacon").severity == Severity::ok);
  }
  SECTION("nobody listens") {
    Observations seen = healthy();
    seen.readers.pop_back();
    CHECK(found(diagnose(seen), "nobody listens to the poses").severity == Severity::note);
    CHECK_FALSE(any_wrong(diagnose(seen)));
  }
}

TEST_CASE("An interface without multicast needs peers") {
  Observations seen = healthy();
  seen.bus.interfaces = {{"lo", false, true}};
  CHECK(found(diagnose(seen), "lo, which has no multicast").severity == Severity::note);
  seen.bus.interfaces = {{"wlan0", false, false}};
  CHECK(found(diagnose(seen), "wlan0, which has no multicast").severity == Severity::warning);
  CHECK_THAT(found(diagnose(seen), "wlan0").remedy, Contains("<Peers>"));
  seen.bus.peers_named = true;
  CHECK_FALSE(any_wrong(diagnose(seen)));
  seen.bus.peers_named = false;
  seen.bus.interfaces = {{"eth0", true, false}};
  CHECK_FALSE(any_wrong(diagnose(seen)));
}

TEST_CASE("A reader that does not match is named with the policy and who it is") {
  Observations seen = healthy();
  seen.readers.push_back(endpoint("sonopose/pose", "sonopose::FusedPose", "planner"));  // shared ownership
  const Finding finding =
      found(diagnose(seen), "planner (process 100 on rover) does not hear sonopose-fusion");
  CHECK(finding.severity == Severity::error);
  CHECK(finding.subject == "sonopose/pose");
  CHECK_THAT(finding.what, Contains("ownership: offered exclusive, requested shared"));
  CHECK_THAT(finding.remedy, Contains("exclusive"));
}

TEST_CASE("A deadline that is too short is an error of its topic alone") {
  Observations seen = healthy();
  seen.readers.front().qos << dds::policy::Deadline{std::chrono::milliseconds(1)};
  CHECK(found(diagnose(seen), "deadline: offered infinite, requested 1 ms").subject == "sonopose/imu");
}

TEST_CASE("Where the fusion does not hear the beacon, what follows from it is not told as well") {
  Observations seen = healthy();
  seen.readers.front().qos << dds::policy::Deadline{std::chrono::milliseconds(1)};
  seen.beacons.front().pose = {};
  seen.beacons.front().fusion->events_lost = 100;
  const auto findings = diagnose(seen);
  CHECK(std::count_if(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.severity >= Severity::warning; }) == 1);
}

TEST_CASE("The same topic with another type is an error") {
  Observations seen = healthy();
  seen.readers.push_back(endpoint("sonopose/imu", "other::Imu", "logger"));
  const Finding finding = found(diagnose(seen), "logger (process 100 on rover) reads it as type other::Imu");
  CHECK(finding.severity == Severity::error);
  CHECK_THAT(finding.remedy, Contains("sonopose.idl"));
}

TEST_CASE("Two fusions of one strength that serve one beacon are a warning, a weaker one stands by") {
  Observations seen = healthy();
  FusionStatus fusion;
  fusion.fusion_id = 1;
  fusion.role = FusionRole::serving;
  fusion.strength = 100;
  seen.beacons.front().fusion = fusion;
  seen.beacons.front().fusions = {fusion, fusion};
  CHECK(found(diagnose(seen), "2 fusions of the same strength 100").severity == Severity::warning);
  seen.beacons.front().fusions.back().strength = 50;
  CHECK_FALSE(any_wrong(diagnose(seen)));
  CHECK_THAT(found(diagnose(seen), "stand by").what, Contains("strength 100"));
  seen.beacons.front().fusions.back().strength = 100;
  seen.beacons.front().fusions.back().role = FusionRole::warming;
  CHECK_FALSE(any_wrong(diagnose(seen)));
}

TEST_CASE("Parts of a domain do not hear each other as meant; a bridge alone in its part is a warning") {
  Observations seen = healthy();
  const dds::Qos east = dds::Qos() << dds::policy::Partition{{"east"}};
  seen.writers.push_back(endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-bridge", east));
  CHECK(found(diagnose(seen), "nobody in its partition hears sonopose-bridge").severity == Severity::warning);
  seen.readers.push_back(endpoint("sonopose/imu", "sonopose::ImuSample", "sonopose-fusion", east));
  CHECK_FALSE(any_wrong(diagnose(seen)));
}

TEST_CASE("The report has the worst last, what to do, and a count") {
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
  CHECK_THAT(report_of({findings[1]}), Contains("nothing is wrong"));

  const auto json = nlohmann::json::parse(json_of(findings));
  CHECK(json["wrong"] == true);
  CHECK(json["findings"].size() == 3);
  CHECK(json["findings"][0]["severity"] == "error");
  CHECK(json["findings"][0]["remedy"] == "pour water");
  CHECK(nlohmann::json::parse(json_of({findings[1]}))["wrong"] == false);
}

TEST_CASE("A process is named as far as it is known") {
  CHECK(text_of(ProcessObservation{"a", "h", 3}) == "a (process 3 on h)");
  CHECK(text_of(ProcessObservation{"a", "", 3}) == "a (process 3)");
  CHECK(text_of(ProcessObservation{"", "h", {}}) == "a process (on h)");
  CHECK(text_of(ProcessObservation{}) == "an unknown process");
}
