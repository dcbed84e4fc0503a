#include "presence/beacon_admission.hpp"

#include "support/test_domain.hpp"
#include "support/wait_until.hpp"

#include <catch2/catch.hpp>

#include <chrono>

namespace sonopose::beacon_admission_test {

using presence::AddressSet;
using presence::BeaconAdmission;

SCENARIO("the beacons that are heard first are admitted") {
  GIVEN("space for two beacons") {
    BeaconAdmission admission({}, 2);
    CHECK(admission.accepts(7));
    CHECK(admission.accepts(8));
    CHECK_FALSE(admission.refusals());
    CHECK_FALSE(admission.warning());
    WHEN("a third one comes") {
      CHECK_FALSE(admission.accepts(9));
      CHECK_FALSE(admission.accepts(9));
      THEN("it is refused and reported once, and the others go on") {
        CHECK(admission.accepts(7));
        CHECK(
            admission.refusals() ==
            "1 address is ignored: the limit is 2 beacons at a time and 32 since the start (--max-beacons)");
        CHECK_FALSE(admission.refusals());
      }
      THEN("it takes the place of one that is gone") {
        admission.forget(7);
        CHECK_THAT(admission.warning().value(), Catch::Contains("1 address is ignored"));
        CHECK(admission.accepts(9));
        CHECK_FALSE(admission.warning());
        CHECK_FALSE(admission.accepts(7));
      }
    }
    WHEN("beacons come and go without end") {
      admission.forget(8);
      for (BeaconAddress address = 100; address < 1000 && admission.accepts(address); ++address) {
        admission.forget(address);
      }
      THEN("new addresses end, known ones may return") {
        CHECK_FALSE(admission.accepts(1000));
        CHECK(admission.accepts(8));
      }
    }
  }
  GIVEN("a list of addresses") {
    BeaconAdmission admission(AddressSet::parse("7-8"), 256);
    THEN("others are not beacons of this process, and not reported") {
      CHECK(admission.accepts(8));
      CHECK_FALSE(admission.accepts(9));
      CHECK_FALSE(admission.refusals());
    }
  }
}

SCENARIO("a flood of new addresses is admitted at a limited pace") {
  constexpr TimeNs ms = 1'000'000;
  BeaconAdmission admission({}, 256, BeaconAdmission::Pace::limited);
  SteadyTime now{1000 * ms};
  const auto admitted_now = [&] {
    int count = 0;
    for (BeaconAddress address = 1; address <= 500; ++address) {
      if (!admission.has(address) && admission.accepts(address, now)) ++count;
    }
    return count;
  };
  CHECK(admitted_now() == 16);
  THEN("the first ones are served, and later ones come in turn and are not reported as too many") {
    CHECK(admission.accepts(1, now));
    for (int i = 0; i < 10; ++i) {
      now += 5 * ms;
      CHECK(admitted_now() == 1);
    }
    CHECK_FALSE(admission.refusals());
  }
  THEN("after a pause several may come at once again") {
    now += 1000 * ms;
    CHECK(admitted_now() == 16);
  }
}

SCENARIO("a topic without measurements admits no beacons") {
  GIVEN("an admission, and a filter for statuses") {
    BeaconAdmission admission({}, 256);
    presence::AdmittedOnly filter(admission);
    CHECK_FALSE(filter.accepts(7));
    CHECK_FALSE(admission.has(7));
    WHEN("a beacon is admitted by a sample") {
      CHECK(admission.accepts(7));
      THEN("its statuses are accepted until it is gone") {
        CHECK(filter.accepts(7));
        CHECK_FALSE(filter.accepts(8));
        admission.forget(7);
        CHECK_FALSE(filter.accepts(7));
      }
    }
  }
}

SCENARIO("DDS makes no instance of a beacon that is not admitted") {
  // Each instance misses its deadline once per period, which reveals the number of instances.
  const sonopose::test::TestDomain domain;
  const auto participant = dds::ext::participant({.domain_id = domain.id()});
  const dds::qos::Provider qos;
  BeaconAdmission admission(AddressSet::parse("7"), 256);
  const bool filtered = GENERATE(true, false);
  auto reader = dds::topics::make_reader(participant, qos, dds::topics::imu, nullptr,
                                         dds::topics::Delivery::live, filtered ? &admission : nullptr);
  auto writer = dds::topics::make_writer(participant, qos, dds::topics::imu);
  sonopose_ImuSample sample{};
  const auto begin = std::chrono::steady_clock::now();
  for (sample.address = 1; sample.address <= 1000; ++sample.address) writer.write(sample);
  const auto passed = [&begin] { return std::chrono::steady_clock::now() - begin; };
  std::int32_t missed = 0;
  REQUIRE(test::wait_until([&] {
    missed = reader.requested_deadline_missed_status().total_count();
    return missed >= (filtered ? 3 : 1000);
  }));
  const auto periods = passed() / dds::deadline_of(qos.datareader_qos(dds::topics::imu.profile));
  const bool one_instance = missed <= periods;
  CHECK(one_instance == filtered);
}

}  // namespace sonopose::beacon_admission_test
