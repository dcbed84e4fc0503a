/// A series of refused fixes is reported once, with the reason.

#include <sonopose/estimation/aiding/fix_refusals.hpp>

#include <catch2/catch.hpp>

namespace fix_refusals_test {

using namespace sonopose;
using Catch::Contains;
using estimation::aiding::FixRefusals;

constexpr TimeNs second_ns = 1'000'000'000;

/// Report on a fix that is older than the IMU's latest sample by `age_s`.
FixReport report(std::uint32_t flags, double age_s) {
  FixReport report;
  report.flags = flags;
  report.applied_time_ns = 1000 * second_ns;
  report.emission_time_ns = report.applied_time_ns - to_ns(age_s);
  return report;
}

SCENARIO("refused fixes are reported once, after a second") {
  const settings::AdmissionSettings limits;
  FixRefusals refusals;
  const auto at = [&refusals](TimeNs time_s) { return refusals.update(SteadyTime{time_s * second_ns}); };
  GIVEN("fixes of a clock that is an hour behind") {
    refusals.on(report(fix_too_late, 3600));
    CHECK_FALSE(at(10));
    refusals.on(report(fix_too_late, 3600.1));
    WHEN("none is accepted") {
      const auto text = at(11);
      THEN("it is reported once, with number and age") {
        REQUIRE(text);
        CHECK_THAT(*text, Contains("all fixes are refused, 2 until now") && Contains("3600.100 s older"));
        CHECK_FALSE(at(12));
      }
      THEN("it is reported when one is accepted") {
        refusals.on(report(fix_used, 0.1));
        const auto end = at(13);
        REQUIRE(end);
        CHECK_THAT(*end, Contains("accepted again"));
        CHECK_FALSE(at(14));
      }
    }
    WHEN("one in a while is accepted") {
      THEN("nothing is reported, although more are refused") {
        for (TimeNs time_s = 11; time_s < 20; ++time_s) {
          refusals.on(report(fix_used, 0.1));
          refusals.on(report(fix_too_late, 3600));
          refusals.on(report(fix_too_late, 3600));
          CHECK_FALSE(at(time_s));
        }
      }
    }
    WHEN("one is accepted, or is an outlier") {
      refusals.on(report(GENERATE(std::uint32_t{fix_used}, std::uint32_t{fix_outlier}), 0.1));
      THEN("nothing is reported") {
        CHECK_FALSE(at(11));
      }
    }
  }
  GIVEN("other reasons") {
    const auto reason_of = [&](const FixReport& one) {
      refusals.on(one);
      refusals.on(one);
      CHECK_FALSE(at(20));
      return at(21).value_or("");
    };
    THEN("each is named") {
      CHECK_THAT(reason_of(report(fix_invalid, -60)), Contains("60.000 s newer than the IMU samples"));
    }
    THEN("low quality is named") {
      CHECK_THAT(reason_of(report(fix_low_quality, 0.1)), Contains("admission.min_quality_percent"));
    }
    THEN("the most frequent one is named, not the latest, with its share") {
      refusals.on(report(fix_low_quality, 0.1));
      refusals.on(report(fix_low_quality, 0.1));
      refusals.on(report(fix_too_late, 3600));
      CHECK_FALSE(at(20));
      const auto text = at(21);
      REQUIRE(text);
      CHECK_THAT(*text, Contains("3 until now") && Contains("2 of them") &&
                            Contains("admission.min_quality_percent") && !Contains("older"));
    }
    THEN("a missing IMU is named") {
      FixReport one = report(fix_invalid, 0.1);
      one.applied_time_ns = 0;
      CHECK_THAT(reason_of(one), Contains("no IMU sample has arrived"));
    }
    THEN("IMU samples that are all above a limit are named with it") {
      FixReport one = report(fix_invalid, 0.1);
      one.applied_time_ns = 0;
      ImuSample fast;
      fast.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
      fast.angular_velocity_body_radps = {100, 0, 0};
      for (int i = 0; i < 340; ++i) refusals.on(fast, limits);
      CHECK_THAT(reason_of(one), Contains("340 IMU samples were refused, above "
                                          "admission.max_angular_rate_radps (80)") &&
                                     !Contains("arrived"));
    }
    THEN("an accelerometer that reads zero is named") {
      FixReport one = report(fix_invalid, 0.1);
      one.applied_time_ns = 0;
      refusals.on(ImuSample{}, limits);
      CHECK_THAT(reason_of(one), Contains("1 IMU sample was refused, with a specific force of zero"));
    }
    THEN("an accelerometer that reads zero is named for a pose that the user sets too") {
      UltrasonicFix start;
      start.flags = ultrasonic_flag_set_pose;
      FixReport one = report(fix_invalid, 0.1);
      one.applied_time_ns = 0;
      refusals.on(ImuSample{}, limits);
      refusals.on(start, limits);
      refusals.on(one);
      CHECK_THAT(at(20).value_or(""), Contains("the pose that the user has set is refused") &&
                                          Contains("with a specific force of zero"));
    }
    THEN("positions as of UTM are named with the limit") {
      UltrasonicFix far;
      far.position_world_m = {452'345, 5'411'234, 230};
      refusals.on(far, limits);
      refusals.on(report(fix_invalid, 0.1));
      refusals.on(far, limits);
      refusals.on(report(fix_invalid, 0.1));
      CHECK_FALSE(at(20));
      CHECK_THAT(at(21).value_or(""),
                 Contains("2 until now: a coordinate is above admission.max_position_m (10000)"));
    }
    THEN("a pose that the user sets there is named alone, and at once") {
      UltrasonicFix far;
      far.position_world_m = {1e7, 0, 0};
      far.flags = ultrasonic_flag_set_pose;
      refusals.on(far, limits);
      refusals.on(report(fix_invalid, -0.01));  // a user's pose is newer than the IMU samples
      CHECK_THAT(at(20).value_or(""),
                 Contains("the pose that the user has set is refused: a coordinate is above "));
      CHECK_FALSE(at(21));
    }
  }
}

SCENARIO("refused fixes of a whole run are counted, also after one that was accepted") {
  estimation::aiding::RefusedFixes refused;
  CHECK(refused.reason().empty());
  CHECK_FALSE(refused.are_of_another_clock());
  CHECK(refused.on(report(fix_invalid, -0.7)));
  CHECK_FALSE(refused.on(report(fix_used, 0.1)));
  CHECK_FALSE(refused.on(report(fix_outlier, 0.1)));
  CHECK(refused.on(report(fix_invalid, -0.7)));
  GIVEN("fixes that are newer than the IMU samples") {
    THEN("they are of another clock") {
      CHECK(refused.count() == 2);
      CHECK_THAT(refused.reason(), Contains("0.700 s newer than the IMU samples"));
      CHECK(refused.are_of_another_clock());
    }
  }
  GIVEN("more of low quality") {
    for (int i = 0; i < 3; ++i) refused.on(report(fix_low_quality, 0.1));
    THEN("their times are not the cause") {
      CHECK_THAT(refused.reason(), Contains("3 of them") && Contains("quality"));
      CHECK_FALSE(refused.are_of_another_clock());
    }
  }
}

}  // namespace fix_refusals_test
