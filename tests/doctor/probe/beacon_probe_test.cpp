#include "doctor/probe/beacon_probe.hpp"

#include <catch2/catch.hpp>

using namespace sonopose;
using namespace sonopose::doctor;

namespace {

constexpr TimeNs begin_ns = 1'000'000'000'000;
constexpr TimeNs period_ns = 10'000'000;
constexpr TimeNs window_ns = 3'000'000'000;

ImuSample imu(std::uint64_t sequence, TimeNs at_ns) {
  ImuSample sample;
  sample.sequence = sequence;
  sample.bridge_time_ns = at_ns;
  sample.specific_force_body_mps2 = {0, 0, 9.8};
  return sample;
}

/// A probe that has had an IMU sample each 10 ms over the window, without those for which `lost(sequence)`.
template <class Lost>
BeaconProbe fed(const Lost& lost) {
  BeaconProbe probe;
  probe.begin(begin_ns);
  std::uint64_t sequence = 1000;
  for (TimeNs at_ns = begin_ns; at_ns < begin_ns + window_ns; at_ns += period_ns) {
    ++sequence;
    if (!lost(sequence)) probe.on(imu(sequence, at_ns), at_ns + 1'000'000, 42);
  }
  return probe;
}

BeaconObservation seen_by(const BeaconProbe& probe) {
  return probe.seen(begin_ns + window_ns, {});
}

bool none(std::uint64_t /*sequence*/) {
  return false;
}

}  // namespace

TEST_CASE("A stream's rate and longest silence are those of the window") {
  const BeaconObservation seen = seen_by(fed([](std::uint64_t n) { return n > 1100 && n <= 1120; }));
  CHECK(seen.imu.samples == 280);
  CHECK(seen.imu.rate_hz == Approx(280 / 3.0));
  CHECK(seen.imu.longest_silence_s == Approx(0.21));
  CHECK(seen.fix.samples == 0);
  CHECK(seen.fix.longest_silence_s == Approx(3.0));
}

TEST_CASE("A silence at the end counts as one in the middle does") {
  CHECK(seen_by(fed([](std::uint64_t n) { return n > 1200; })).imu.longest_silence_s ==
        Approx(1.0).epsilon(0.02));
}

TEST_CASE("What came before the window is no part of it") {
  BeaconProbe probe;
  for (std::uint64_t n = 1; n <= 100; ++n)
    probe.on(imu(n, begin_ns - 1'000'000'000), begin_ns - 1'000'000'000, 1);
  probe.begin(begin_ns);
  const BeaconObservation seen = seen_by(probe);
  CHECK(seen.imu.samples == 0);
  CHECK(probe.writers().empty());
  CHECK_FALSE(seen.imu_means);
}

TEST_CASE("Events that are missing in the numbering are counted over all streams") {
  SECTION("none is missing") {
    CHECK(seen_by(fed(none)).events_missing == 0);
  }
  SECTION("three are") {
    CHECK(seen_by(fed([](std::uint64_t n) { return n == 1050 || n == 1051 || n == 1180; })).events_missing ==
          3);
  }
  SECTION("one of them is a fix, which came by its own stream") {
    BeaconProbe probe = fed([](std::uint64_t n) { return n == 1050; });
    UltrasonicFix fix;
    fix.sequence = 1050;
    probe.on(fix, begin_ns + 600'000'000);
    CHECK(seen_by(probe).events_missing == 0);
  }
  SECTION("what may still be on its way is not missing") {
    CHECK(seen_by(fed([](std::uint64_t n) { return n == 1299; })).events_missing == 0);
  }
  SECTION("a bridge that begins anew begins its numbering anew") {
    BeaconProbe probe = fed(none);
    for (std::uint64_t n = 1; n < 50; ++n) probe.on(imu(n, begin_ns), begin_ns + 2'500'000'000, 43);
    CHECK(seen_by(probe).events_missing == 0);
  }
}

TEST_CASE("The bridge's clock is compared by the median") {
  BeaconProbe probe = fed(none);
  probe.on(imu(5000, begin_ns - 900'000'000'000), begin_ns, 42);  // a single stamp that is absurd
  CHECK(seen_by(probe).bridge_ahead_s.value() == Approx(-0.001).margin(1e-6));
}

TEST_CASE("A status bit lasts where every pose of the window has it") {
  BeaconProbe probe;
  probe.begin(begin_ns);
  FusedPose pose;
  for (const std::uint32_t status : {status_stale | status_low_trust, status_stale | status_imu_gap}) {
    pose.status = status;
    probe.on(pose, begin_ns + 1);
  }
  CHECK(seen_by(probe).lasting_status == status_stale);
  CHECK(BeaconProbe().seen(begin_ns, {}).lasting_status == 0);
}

TEST_CASE("Means are those that the fusion's calibration makes of the readings") {
  calibration::Settings settings =
      calibration_in({.address = 7,
                      .values = {{"calibration.axes", "+x-z+y"},
                                 {"calibration.accelerometer.offset_z_mps2", "1.8"},
                                 {"calibration.nothing_known", "3"},
                                 {"drift.jump_alpha", "nonsense"}}});
  const auto seen = fed(none).seen(begin_ns + window_ns, settings);
  REQUIRE(seen.imu_means);
  // (0, 0, 9.8) less the offset is 8 on the sensor's Z, which is body -Y.
  CHECK(seen.imu_means->mean_force_body_mps2.isApprox(Vector3d(0, -8.0, 0), 1e-9));
  CHECK(seen.imu_means->force_std_mps2 < 1e-9);
}
