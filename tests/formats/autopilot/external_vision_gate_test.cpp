#include "autopilot/external_vision_gate.hpp"

#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>

namespace external_vision_gate_test {

using namespace sonopose;
using autopilot::ExternalVisionGate;
using autopilot::NotSent;

/// A fusion at 100 Hz: a body on its way along x at 1 m/s that turns left at 0.5 rad/s.
class Fusion {
public:
  FusedPose next() {
    time_ns_ += 10'000'000;
    const double time_s = to_s(time_ns_);
    FusedPose pose;
    pose.time_ns = time_ns_;
    pose.position_world_m = Vector3d(time_s, 0, 1) + offset_m;
    pose.velocity_world_mps = {1, 0, 0};
    pose.angular_velocity_body_radps = {0, 0, 0.5};
    pose.q_body_to_world = geometry::rotation_about_z(0.5 * time_s + turned_rad);
    pose.pose_covariance = Covariance<6>::from_diagonal(Eigen::Matrix<double, 6, 1>::Constant(1e-3));
    pose.trust = trust;
    pose.status = status;
    pose.reset_counter = resets;
    return pose;
  }

  /// Lets time pass in which the body stands, without poses.
  void pause(double pause_s) {
    time_ns_ += static_cast<TimeNs>(pause_s * 1e9);
    offset_m.x() -= pause_s;
    turned_rad -= 0.5 * pause_s;
  }

  Vector3d offset_m = Vector3d::Zero();
  double turned_rad = 0;
  double trust = 0.9;
  std::uint32_t status = 0;
  std::uint32_t resets = 0;

private:
  static double to_s(TimeNs time_ns) { return static_cast<double>(time_ns) * 1e-9; }
  TimeNs time_ns_ = 1'000'000'000;
};

/// The verdict after the time without doubt that a start needs.
ExternalVisionGate::Verdict settle(ExternalVisionGate& gate, Fusion& fusion) {
  for (int i = 0; i < 50; ++i) gate.on(fusion.next());
  return gate.on(fusion.next());
}

/// Watches poses for a second; returns the counter afterwards.
int counter_after(ExternalVisionGate& gate, Fusion& fusion) {
  for (int i = 0; i < 100; ++i) {
    gate.on(fusion.next());
    if (i % 3 == 0) static_cast<void>(gate.take_reset_counter());
  }
  return gate.take_reset_counter();
}

SCENARIO("a jump raises the reset counter once") {
  GIVEN("a moving body that is watched for a second") {
    ExternalVisionGate gate;
    Fusion fusion;
    REQUIRE(counter_after(gate, fusion) == 0);
    WHEN("nothing happens") {
      THEN("the counter stays") {
        CHECK(counter_after(gate, fusion) == 0);
      }
    }
    WHEN("a fix corrects the position by 5 cm") {
      fusion.offset_m = {0, 0.05, 0};
      THEN("that is no jump") {
        CHECK(counter_after(gate, fusion) == 0);
      }
    }
    WHEN("the estimate moves by a metre") {
      fusion.offset_m = {0, 1, 0};
      THEN("it counts once") {
        CHECK(counter_after(gate, fusion) == 1);
      }
    }
    WHEN("the yaw turns by 20°") {
      fusion.turned_rad = 0.35;
      THEN("it counts once") {
        CHECK(counter_after(gate, fusion) == 1);
      }
    }
    WHEN("the engine starts again, is without a position for a second, and is then elsewhere") {
      fusion.resets = 1;
      fusion.status = status_initialising;
      for (int i = 0; i < 100; ++i) gate.on(fusion.next());
      fusion.status = 0;
      fusion.offset_m = {3, 1, 0};
      THEN("it counts once") {
        CHECK(counter_after(gate, fusion) == 1);
      }
    }
    WHEN("another fusion, which has counted no reset either, starts") {
      fusion.status = status_initialising;
      for (int i = 0; i < 10; ++i) gate.on(fusion.next());
      fusion.status = 0;
      THEN("it counts once") {
        CHECK(counter_after(gate, fusion) == 1);
      }
    }
    WHEN("it jumps twice between two messages") {
      fusion.offset_m = {0, 1, 0};
      gate.on(fusion.next());
      fusion.offset_m = {0, 2, 0};
      gate.on(fusion.next());
      THEN("that is one reset for the autopilot") {
        CHECK(int{gate.take_reset_counter()} == 1);
      }
    }
    WHEN("the bridge is away for 8 s, and a fix corrects the stale pose by 2 m 70 ms later") {
      fusion.pause(8);
      fusion.status = status_stale | status_imu_gap;
      for (int i = 0; i < 7; ++i) REQUIRE(gate.on(fusion.next()).not_sent == NotSent::doubtful);
      fusion.status = status_converging;
      fusion.offset_m.y() += 2;
      for (int i = 0; i < 50; ++i) REQUIRE(gate.on(fusion.next()).not_sent == NotSent::doubtful);
      fusion.status = 0;
      for (int i = 0; i < 20; ++i) REQUIRE(gate.on(fusion.next()).not_sent == NotSent::doubtful);
      fusion.offset_m.y() += 0.5;  // the next fixes
      THEN("it counts once") {
        REQUIRE(settle(gate, fusion).not_sent == NotSent::none);
        CHECK(counter_after(gate, fusion) == 1);
      }
    }
    WHEN("an unknown yaw becomes known elsewhere") {
      fusion.status = status_heading_unknown;
      static_cast<void>(counter_after(gate, fusion));
      fusion.turned_rad = 2;
      gate.on(fusion.next());
      fusion.status = 0;
      THEN("that is no jump: there was no yaw before") {
        CHECK(counter_after(gate, fusion) == 0);
      }
    }
  }
}

SCENARIO("a doubt of unknown age sends nothing") {
  GIVEN("a gate that begins, or gets poses again, in an outage") {
    ExternalVisionGate gate;
    Fusion fusion;
    const std::string before = GENERATE(values<std::string>({"nothing", "a pause", "no position"}));
    CAPTURE(before);
    if (before != "nothing") REQUIRE(settle(gate, fusion).not_sent == NotSent::none);
    if (before == "a pause") fusion.pause(2);
    if (before == "no position") {
      fusion.status = status_initialising;
      gate.on(fusion.next());
    }
    fusion.status = status_stale;
    THEN("the first pose is not sent, nor one that follows") {
      for (int i = 0; i < 400; ++i) REQUIRE(gate.on(fusion.next()).not_sent == NotSent::doubtful);
      AND_WHEN("poses are good for half a second, and the next is stale again") {
        fusion.status = 0;
        REQUIRE(gate.on(fusion.next()).not_sent == NotSent::doubtful);
        const auto good = settle(gate, fusion);
        fusion.status = status_stale;
        const auto stale = gate.on(fusion.next());
        THEN("both are sent: that doubt is young") {
          CHECK(good.not_sent == NotSent::none);
          CHECK(stale.not_sent == NotSent::none);
        }
      }
    }
  }
}

SCENARIO("the quality falls while the poses are doubtful, and then there are none") {
  GIVEN("poses with a trust of 90 %") {
    ExternalVisionGate gate;
    Fusion fusion;
    REQUIRE(int{settle(gate, fusion).quality_percent} == 90);
    WHEN("they are stale, untrusted or inconsistent") {
      fusion.status =
          GENERATE(std::uint32_t{status_stale}, std::uint32_t{status_low_trust},
                   std::uint32_t{status_imu_inconsistent}, std::uint32_t{status_fixes_inconsistent});
      int last = 90;
      int sent = 0;
      ExternalVisionGate::Verdict verdict;
      for (; sent < 1000; ++sent) {
        verdict = gate.on(fusion.next());
        if (verdict.not_sent != NotSent::none) break;
        REQUIRE(int{verdict.quality_percent} <= last);
        last = verdict.quality_percent;
      }
      THEN("the quality falls to 1 %, and after 3 s none is sent") {
        CHECK(last == 1);
        CHECK(sent == 300);
        CHECK(verdict.not_sent == NotSent::doubtful);
      }
      AND_WHEN("they are good again for half a second") {
        fusion.status = 0;
        THEN("they are sent with full quality") {
          const auto good = settle(gate, fusion);
          CHECK(good.not_sent == NotSent::none);
          CHECK(int{good.quality_percent} == 90);
        }
      }
    }
    WHEN("they are late") {
      fusion.status = status_late;
      THEN("none is sent any more") {
        CHECK(gate.on(fusion.next()).not_sent == NotSent::late);
      }
    }
    WHEN("there is no position") {
      fusion.status = status_initialising;
      THEN("none is sent") {
        CHECK(gate.on(fusion.next()).not_sent == NotSent::no_position);
      }
    }
    WHEN("its time or position is impossible") {
      FusedPose pose = fusion.next();
      pose.position_world_m.x() = std::nan("");
      THEN("none is sent") {
        CHECK(gate.on(pose).not_sent == NotSent::no_position);
        pose = fusion.next();
        pose.time_ns = std::numeric_limits<TimeNs>::min();
        CHECK(gate.on(pose).not_sent == NotSent::no_position);
      }
    }
    WHEN("the trust is zero or no number") {
      THEN("the quality is 1 %, because 0 means unknown") {
        fusion.trust = 0;
        CHECK(int{gate.on(fusion.next()).quality_percent} == 1);
        fusion.trust = std::nan("");
        CHECK(int{gate.on(fusion.next()).quality_percent} == 1);
      }
    }
  }
}

TEST_CASE("The clock of a pose is that of the host, or it is far from it") {
  constexpr TimeNs now = 1'700'000'000'000'000'000;
  constexpr TimeNs ms = 1'000'000;
  for (const TimeNs usual : {now, now - 300 * ms, now + 50 * ms}) CHECK(autopilot::is_of_clock(usual, now));
  for (const TimeNs other : {TimeNs{0}, now - 1001 * ms, now + 1001 * ms, end_of_time_ns}) {
    CHECK_FALSE(autopilot::is_of_clock(other, now));
  }
}

}  // namespace external_vision_gate_test
