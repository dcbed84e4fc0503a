#include "sim/disturbances.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace disturbances_test {

using namespace sonopose;
using namespace sonopose::sim;

constexpr int many = 200'000;

/// Four standard deviations of a measured share.
double margin_of(double share) {
  return 4.0 * std::sqrt(share * (1.0 - share) / many);
}

struct Counted {
  double lost = 0;  ///< shares
  double doubled = 0;
  double late = 0;
  double min_late_s = 1e9;
  double max_late_s = 0;
  int longest_run = 0;
};

Counted count(const PacketFaults& faults) {
  PacketChannel channel(faults, Random(1));
  Counted counted;
  int run = 0;
  for (int i = 0; i < many; ++i) {
    const PacketFate fate = channel.next();
    run = fate.copies == 0 ? run + 1 : 0;
    counted.longest_run = std::max(counted.longest_run, run);
    if (fate.copies == 0) counted.lost += 1.0 / many;
    if (fate.copies == 2) counted.doubled += 1.0 / many;
    if (fate.late_s > 0) {
      counted.late += 1.0 / many;
      counted.min_late_s = std::min(counted.min_late_s, fate.late_s);
      counted.max_late_s = std::max(counted.max_late_s, fate.late_s);
    }
  }
  return counted;
}

std::string refusal(const Disturbances& disturbances) {
  try {
    check(disturbances);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

SCENARIO("packet faults occur with the configured shares") {
  GIVEN("single losses, copies and late ones") {
    const Counted counted =
        count({.dropped_share = 0.02, .duplicated_share = 0.05, .late_share = 0.1, .late_by_s = {0.05, 0.3}});
    CHECK(counted.lost == Approx(0.02).margin(margin_of(0.02)));
    CHECK(counted.doubled == Approx(0.05).margin(margin_of(0.05)));
    CHECK(counted.late == Approx(0.1).margin(margin_of(0.1)));
    CHECK(counted.min_late_s >= 0.05);
    CHECK(counted.min_late_s < 0.06);
    CHECK(counted.max_late_s <= 0.3);
    CHECK(counted.max_late_s > 0.29);
  }
  GIVEN("losses in runs of three to six") {
    const Counted counted = count({.lost_runs_share = 0.001});
    // A run of losses has a mean length of 4.5; the shares are of the packets outside such runs.
    CHECK(counted.lost == Approx(0.0045 / 1.0035).epsilon(0.3));
    CHECK(counted.longest_run == 6);
  }
  GIVEN("a good line") {
    const Counted counted = count({});
    CHECK(counted.lost + counted.doubled + counted.late == 0.0);
  }
}

SCENARIO("poor fixes occur with the configured share") {
  const Disturbances disturbances{.poor_fixes = {{.share = 0.25}, {.share = 0.1}}};
  Random random(1);
  double first = 0;
  double second = 0;
  for (int i = 0; i < many; ++i) {
    const PoorFixes* kind = draw_poor_fix(disturbances, random);
    if (kind == disturbances.poor_fixes.data()) first += 1.0 / many;
    if (kind == &disturbances.poor_fixes[1]) second += 1.0 / many;
  }
  CHECK(first == Approx(0.25).margin(margin_of(0.25)));
  CHECK(second == Approx(0.1).margin(margin_of(0.1)));
  CHECK(draw_poor_fix({}, random) == nullptr);
}

SCENARIO("spikes lie at the configured distance in any direction") {
  GIVEN("spikes of 0.3 to 3 m") {
    const PoorFixes kind{.share = 0.03, .offset_m = {0.3, 3.0}};
    Random random(1);
    constexpr int count = 20'000;
    Vector3d mean_m = Vector3d::Zero();
    double mean_distance_m = 0;
    for (int i = 0; i < count; ++i) {
      const Vector3d offset_m = draw_offset_world_m(kind, random);
      REQUIRE(offset_m.norm() >= 0.3);
      REQUIRE(offset_m.norm() <= 3.0);
      mean_m += offset_m / count;
      mean_distance_m += offset_m.norm() / count;
    }
    CHECK(mean_distance_m == Approx(1.65).margin(0.03));
    CHECK(mean_m.norm() < 0.05);
  }
  GIVEN("a kind without an offset") {
    Random random(1);
    CHECK(draw_offset_world_m({.share = 0.5}, random) == Vector3d::Zero());
    THEN("nothing was drawn") {
      CHECK(random.uniform() == Random(1).uniform());
    }
  }
}

SCENARIO("disturbances begin and end on time") {
  GIVEN("an outage from 5 to 7 s") {
    const Disturbances disturbances{.outages = {{5.0, 2.0}}};
    THEN("it is there from 5 s to just before 7 s") {
      CHECK_FALSE(is_outage(disturbances.outages, 4.999));
      CHECK(is_outage(disturbances.outages, 5.0));
      CHECK(is_outage(disturbances.outages, 6.999));
      CHECK_FALSE(is_outage(disturbances.outages, 7.0));
      CHECK_FALSE(is_outage({}, 6.0));
    }
  }
  GIVEN("a halved fix rate from 5 to 7 s") {
    const Disturbances disturbances{.halved_fix_rates = {{5.0, 2.0}}};
    THEN("every other fix of that time is left out") {
      CHECK_FALSE(is_left_out(disturbances, 4.999, 51));
      CHECK(is_left_out(disturbances, 5.0, 51));
      CHECK_FALSE(is_left_out(disturbances, 5.1, 52));
      CHECK(is_left_out(disturbances, 6.999, 53));
      CHECK_FALSE(is_left_out(disturbances, 7.0, 53));
    }
  }
  GIVEN("a burst from 5 to 7 s") {
    const Vector3d offset(1.0, -2.0, 0.5);
    const Disturbances disturbances{.outlier_bursts = {{5.0, 2.0, offset}}};
    const Vector3d anywhere(3.0, 4.0, 5.0);
    THEN("fixes of that time are off by its offset") {
      CHECK(track_offset_world_m(disturbances, 4.999, anywhere) == Vector3d::Zero());
      CHECK(track_offset_world_m(disturbances, 5.0, anywhere) == offset);
      CHECK(track_offset_world_m(disturbances, 7.0, anywhere) == Vector3d::Zero());
    }
  }
  GIVEN("a track that drifts away by 0.5 m/s from 5 to 9 s") {
    const Disturbances disturbances{
        .outlier_bursts = {{.begin_s = 5.0, .duration_s = 4.0, .drift_world_mps = {0.3, 0.0, -0.4}}}};
    THEN("fixes of that time are off by the way that it went") {
      CHECK(track_offset_world_m(disturbances, 5.0, Vector3d::Zero()) == Vector3d::Zero());
      CHECK((track_offset_world_m(disturbances, 7.0, Vector3d::Zero()) - Vector3d(0.6, 0.0, -0.8)).norm() <
            1e-12);
      CHECK(track_offset_world_m(disturbances, 9.0, Vector3d::Zero()) == Vector3d::Zero());
    }
  }
  GIVEN("a track that a wall at 45° through the origin mirrors") {
    const Wall wall{Vector3d::Zero(), Vector3d(1.0, -1.0, 0.0).normalized()};
    const Disturbances disturbances{.outlier_bursts = {{.duration_s = 9.0, .mirror = wall}}};
    THEN("x and y change places and the height stays") {
      const Vector3d position(1.0, 3.0, 0.7);
      const Vector3d mirrored = position + track_offset_world_m(disturbances, 5.0, position);
      CHECK((mirrored - Vector3d(3.0, 1.0, 0.7)).norm() < 1e-12);
    }
  }
  GIVEN("two relocations") {
    const Disturbances disturbances{.relocations = {{5.0, {1, 0, 0}}, {9.0, {0, 2, 0}}}};
    THEN("each moves the truth from its time on") {
      CHECK(relocated(disturbances, 4.999, {}).position_world_m == Vector3d::Zero());
      CHECK(relocated(disturbances, 5.0, {}).position_world_m == Vector3d(1, 0, 0));
      CHECK(relocated(disturbances, 100.0, {}).position_world_m == Vector3d(1, 2, 0));
    }
  }
  GIVEN("a map that turns by 90° about (1, 0) and shifts by 5 m along X") {
    const Disturbances disturbances{.relocations = {{5.0, {5, 0, 0}, std::numbers::pi / 2, {1, 0, 0}}}};
    Motion motion;
    motion.position_world_m = {3, 0, 1};
    motion.velocity_world_mps = {2, 0, 0};
    const Motion after = relocated(disturbances, 6.0, motion);
    THEN("position, velocity and yaw turn with it") {
      CHECK((after.position_world_m - Vector3d(6, 2, 1)).norm() < 1e-12);
      CHECK((after.velocity_world_mps - Vector3d(0, 2, 0)).norm() < 1e-12);
      CHECK((after.q_body_to_world * Vector3d::UnitX() - Vector3d::UnitY()).norm() < 1e-12);
    }
  }
  GIVEN("a heading that is off by up to 0.5 rad from 5 to 9 s") {
    const Disturbances disturbances{.heading_errors = {{5.0, 4.0, 0.5}}};
    THEN("the error rises, falls and is over") {
      CHECK(heading_error_rad(disturbances, 4.999) == 0.0);
      CHECK(heading_error_rad(disturbances, 5.0) == 0.0);
      CHECK(heading_error_rad(disturbances, 6.0) == Approx(0.25));
      CHECK(heading_error_rad(disturbances, 7.0) == Approx(0.5));
      CHECK(heading_error_rad(disturbances, 8.999) < 1e-6);
      CHECK(heading_error_rad(disturbances, 9.0) == 0.0);
    }
  }
  GIVEN("a gyro that drifts from 5 to 9 s") {
    const Disturbances disturbances{.gyro_drift = GyroDrift{5.0, 4.0, {0.4, 0.0, -0.8}}};
    THEN("the error grows with time, and stays") {
      CHECK(gyro_drift_body_radps(disturbances, 5.0) == Vector3d::Zero());
      CHECK((gyro_drift_body_radps(disturbances, 6.0) - Vector3d(0.1, 0.0, -0.2)).norm() < 1e-12);
      CHECK(gyro_drift_body_radps(disturbances, 50.0) == Vector3d(0.4, 0.0, -0.8));
      CHECK(gyro_drift_body_radps({}, 6.0) == Vector3d::Zero());
    }
  }
}

SCENARIO("invalid disturbances are refused by name") {
  CHECK(refusal({}) == "accepted");
  CHECK_THAT(refusal({.outages = {{1.0, -2.0}}}),
             Catch::Contains("outages.duration_s") && Catch::Contains("-2"));
  CHECK_THAT(refusal({.outlier_bursts = {{-1.0, 2.0, {}}}}), Catch::Contains("outlier_bursts.begin_s"));
  CHECK_THAT(refusal({.relocations = {{1.0, Vector3d::Constant(std::numeric_limits<double>::infinity())}}}),
             Catch::Contains("relocations.by_world_m"));
  CHECK_THAT(refusal({.poor_fixes = {{.share = 1.5}}}), Catch::Contains("poor_fixes.share"));
  CHECK_THAT(refusal({.poor_fixes = {{.share = 0.6}, {.share = 0.6}}}), Catch::Contains("sum of the shares"));
  CHECK_THAT(refusal({.poor_fixes = {{.share = 0.5, .quality_percent = Range{50.0, 120.0}}}}),
             Catch::Contains("quality_percent") && Catch::Contains("120"));
  CHECK_THAT(refusal({.poor_fixes = {{.share = 0.5, .offset_m = {3.0, 0.3}}}}),
             Catch::Contains("poor_fixes.offset_m"));
  CHECK_THAT(refusal({.imu_outages = {{1.0, -2.0}}}), Catch::Contains("imu_outages.duration_s"));
  CHECK_THAT(refusal({.outlier_bursts = {{.mirror = Wall{Vector3d::Zero(), {2, 0, 0}}}}}),
             Catch::Contains("mirror.normal_world"));
  CHECK_THAT(refusal({.outlier_bursts = {{.mirror = Wall{Vector3d::Zero(), {0, 0, 1}}}}}),
             Catch::Contains("mirror.normal_world.z"));
  CHECK_THAT(refusal({.relocations = {{.at_s = 1.0, .turn_rad = std::nan("")}}}),
             Catch::Contains("relocations.turn_rad"));
  CHECK_THAT(refusal({.heading_errors = {{1.0, 2.0, std::nan("")}}}),
             Catch::Contains("heading_errors.peak_rad"));
  CHECK_THAT(refusal({.imu_packets = {.dropped_share = std::nan("")}}),
             Catch::Contains("imu_packets.dropped_share"));
  CHECK_THAT(refusal({.position_packets = {.late_share = 0.1, .late_by_s = {0.3, 0.1}}}),
             Catch::Contains("position_packets.late_by_s"));
}

SCENARIO("a stationary beacon that the map has in the wrong place moves the fixes") {
  GIVEN("three beacons, of which the map has one 10 cm off") {
    const std::vector<Vector3d> beacons{{0, 0, 3}, {6, 0, 3}, {3, 4, 2.5}};
    const Vector3d map_error_m{0.06, 0.08, 0.0};
    const Disturbances disturbances{
        .misplaced_beacon =
            MisplacedBeacon{.beacons_world_m = beacons, .misplaced = 1, .map_error_m = map_error_m}};
    THEN("the fix has the measured range to each place on the map") {
      const Vector3d position_m{2.0, 1.0, 1.0};
      const Vector3d fix_m = position_m + track_offset_world_m(disturbances, 1.0, position_m);
      CHECK((fix_m - position_m).norm() > 0.02);
      for (std::size_t i = 0; i < beacons.size(); ++i) {
        const Vector3d on_map_m = beacons[i] + (i == 1 ? map_error_m : Vector3d::Zero());
        CHECK((fix_m - on_map_m).norm() == Approx((position_m - beacons[i]).norm()).margin(0.005));
      }
    }
  }
  CHECK(refusal({.misplaced_beacon = MisplacedBeacon{}}).find("misplaced_beacon") != std::string::npos);
}

}  // namespace disturbances_test
