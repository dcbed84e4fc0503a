#include <sonopose/estimation/kalman/imu_steps.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace kalman_imu_steps_test {

using namespace sonopose;
using namespace sonopose::estimation::kalman;

constexpr TimeNs epoch_ns = 1'700'000'000'000'000'000;

SCENARIO("the usual step of an IMU is regular at any rate") {
  const auto is_irregular = [](double step_s, double usual_s) {
    return step_between(ImuMeasurement{.time_ns = epoch_ns},
                        ImuMeasurement{.time_ns = epoch_ns + to_ns(step_s)}, usual_s)
        .irregular;
  };
  for (const double rate_hz : {25.0, 30.0, 33.0, 100.0}) {
    CAPTURE(rate_hz);
    double usual_s = 0.0;
    for (int k = 0; k < 200; ++k)
      usual_s = nominal_imu_period_s(usual_s, (k % 50 == 49 ? 3.0 : 1.0) / rate_hz);
    CHECK_FALSE(is_irregular(1.05 / rate_hz, usual_s));
    CHECK(is_irregular(3.0 / rate_hz, usual_s));
  }
}

SCENARIO("a joined step turns and moves a body like the steps that it consists of") {
  GIVEN("ten steps of 1 ms of a body that vibrates about and along two axes, at 25 Hz") {
    // The axes vibrate in quadrature: the body cones, and its force does not average out (sculling).
    constexpr double step_s = 1e-3;
    const double began_s = GENERATE(0.0, 0.003, 0.017, 0.032);
    CAPTURE(began_s);
    ImuPreintegrator steps;
    Quaterniond q_after = Quaterniond::Identity();
    Vector3d velocity_mps = Vector3d::Zero();
    Vector3d turn_rad = Vector3d::Zero();
    Vector3d impulse_mps = Vector3d::Zero();
    for (int k = 0; k < 10; ++k) {
      const double phase = 2.0 * std::numbers::pi * 25.0 * (began_s + (k + 0.5) * step_s);
      const ImuStep step{.duration_s = step_s,
                         .rate_body_radps = {3.0 * std::cos(phase), 3.0 * std::sin(phase), 0.5},
                         .force_body_mps2 = {8.0 * std::sin(phase), 5.0 * std::cos(phase), 9.8}};
      const Vector3d half_rad = 0.5 * step_s * step.rate_body_radps;
      velocity_mps += step_s * ((q_after * geometry::rotation_by(half_rad)) * step.force_body_mps2);
      q_after = q_after * geometry::rotation_by((2.0 * half_rad).eval());
      turn_rad += step_s * step.rate_body_radps;
      impulse_mps += step_s * step.force_body_mps2;
      steps.add(step);
    }
    const ImuStep joined = steps.joined();
    const auto velocity_after = [](const Vector3d& rotation_rad, const Vector3d& body_mps) -> Vector3d {
      return geometry::rotation_by((0.5 * rotation_rad).eval()) * body_mps;
    };
    THEN("the joined one is ten times as accurate as one step with the means") {
      REQUIRE(joined.duration_s == Approx(0.01));
      const Vector3d joined_rad = joined.duration_s * joined.rate_body_radps;
      const double error_rad = q_after.angularDistance(geometry::rotation_by(joined_rad));
      const double mean_error_rad = q_after.angularDistance(geometry::rotation_by(turn_rad));
      CHECK(mean_error_rad > 3e-5);
      CHECK(error_rad < 0.1 * mean_error_rad);
      const Vector3d joined_mps = joined.duration_s * joined.force_body_mps2;
      const double error_mps = (velocity_mps - velocity_after(joined_rad, joined_mps)).norm();
      const double mean_error_mps = (velocity_mps - velocity_after(turn_rad, impulse_mps)).norm();
      CHECK(mean_error_mps > 1e-4);
      CHECK(error_mps < 0.1 * mean_error_mps);
    }
  }
}

SCENARIO("one step alone is returned unchanged") {
  const ImuStep step{
      .duration_s = 0.0101, .rate_body_radps = {0.1, -0.7, 0.3}, .force_body_mps2 = {0.3, 0.7, 9.7}};
  ImuPreintegrator steps;
  CHECK(steps.empty());
  steps.add(step);
  CHECK_FALSE(steps.empty());
  CHECK_FALSE(steps.joined_differs());
  CHECK(steps.joined() == step);
}

/// Velocity variance along Z due to a half-sine pulse of the specific force.
double shock_variance(double peak_mps2, double duration_s, double rate_hz) {
  ShockDetector shocks;
  double variance = 0.0;
  for (double time_s = 0.0; time_s < 2.0; time_s += 1.0 / rate_hz) {
    const double since_s = time_s - 1.0;
    const double pulse_mps2 = since_s >= 0.0 && since_s < duration_s
                                  ? peak_mps2 * std::sin(std::numbers::pi * since_s / duration_s)
                                  : 0.0;
    const Vector3d error = shocks.add({0.0, 0.0, standard_gravity_mps2 + pulse_mps2}, 1.0 / rate_hz, 2.5);
    CHECK(error.head<2>().isZero(0.0));  // it leaves the other axes as they are
    variance += error.squaredNorm();
  }
  return variance;
}

SCENARIO("only a shock makes the velocity uncertain") {
  const double rate_hz = GENERATE(100.0, 200.0, 1000.0);
  GIVEN("an IMU of " + std::to_string(rate_hz) + " Hz") {
    WHEN("a wheel passes a sill: 10 m/s² for 30 ms") {
      const double impulse_mps = 10.0 * 0.03 * 2.0 / std::numbers::pi;
      THEN("the uncertainty is about that of its impulse") {
        const double std_mps = std::sqrt(shock_variance(10.0, 0.03, rate_hz));
        CHECK(std_mps > 0.3 * impulse_mps);
        CHECK(std_mps < 3.0 * impulse_mps);
      }
    }
    WHEN("a truck brakes: 17 m/s² for a quarter of a second") {
      THEN("there is none") {
        CHECK(shock_variance(17.0, 0.25, rate_hz) == 0.0);
      }
    }
  }
}

struct Motion {
  Vector3d velocity_mps = Vector3d::Zero();
  Vector3d position_m = Vector3d::Zero();

  void add(const Vector3d& acceleration_mps2, double duration_s) {
    position_m += duration_s * (velocity_mps + 0.5 * duration_s * acceleration_mps2);
    velocity_mps += duration_s * acceleration_mps2;
  }
};

SCENARIO("a few wrong samples move nothing, and a sudden motion is made up for") {
  GIVEN("readings of an accelerometer at 100 Hz that leave 9.8 m/s² suddenly") {
    constexpr double step_s = 0.01;
    constexpr double max_jump_mps2 = 20.0;
    const Vector3d usual_mps2{0.0, 0.0, 9.8};
    const int changed = GENERATE(1, 2, 4, 30);
    const Vector3d change_mps2 = GENERATE(Vector3d{157.0, 0.0, 0.0}, Vector3d{0.0, -30.0, -30.0});
    CAPTURE(changed, change_mps2.transpose());
    SpikeFilter spikes;
    Vector3d last_mps2 = usual_mps2;
    Motion used;
    Motion measured;
    Vector3d last_measured_mps2 = usual_mps2;
    for (int k = 0; k < 40; ++k) {
      const bool is_changed = k >= 5 && k < 5 + changed;
      const Vector3d reading_mps2 = is_changed ? Vector3d(usual_mps2 + change_mps2) : usual_mps2;
      const auto output = spikes.add(last_mps2, reading_mps2, step_s, max_jump_mps2);
      used.add(0.5 * (last_mps2 + output.reading_body) + output.made_up_body / step_s - usual_mps2, step_s);
      used.position_m += output.made_up_shift_body;
      const Vector3d right_mps2 = changed > 4 ? reading_mps2 : usual_mps2;
      measured.add(0.5 * (last_measured_mps2 + right_mps2) - usual_mps2, step_s);
      last_mps2 = output.reading_body;
      last_measured_mps2 = right_mps2;
    }
    THEN("up to four of them move nothing, and what lasts moves the body as it should") {
      CHECK((used.velocity_mps - measured.velocity_mps).norm() < 1e-9);
      CHECK((used.position_m - measured.position_m).norm() < 1e-9);
    }
  }
  GIVEN("a collision: 2 m/s within 20 to 60 ms, as a sensor of 35 Hz bandwidth shows it") {
    const double rate_hz = GENERATE(100.0, 200.0, 1000.0);
    const double lasts_s = GENERATE(0.02, 0.04, 0.06);
    CAPTURE(rate_hz, lasts_s);
    constexpr double fine_s = 1e-4;
    constexpr double filter_s = 1.0 / (2.0 * std::numbers::pi * 35.0);
    SpikeFilter spikes;
    Vector3d last_mps2 = Vector3d::Zero();
    double first_mps2 = 0.0;
    double second_mps2 = 0.0;
    double used_mps = 0.0;
    double held_s = 0.0;
    for (int k = 0; k < 3000; ++k) {
      const double phase = (k * fine_s - 0.1) / lasts_s;
      const double true_mps2 =
          phase > 0.0 && phase < 1.0 ? std::numbers::pi / lasts_s * std::sin(std::numbers::pi * phase) : 0.0;
      first_mps2 += fine_s / filter_s * (true_mps2 - first_mps2);
      second_mps2 += fine_s / filter_s * (first_mps2 - second_mps2);
      if (k % static_cast<int>(1.0 / (fine_s * rate_hz)) != 0) continue;
      const auto output = spikes.add(last_mps2, {second_mps2, 0.0, 0.0}, 1.0 / rate_hz, 20.0);
      used_mps += output.reading_body.x() / rate_hz + output.made_up_body.x();
      last_mps2 = output.reading_body;
      held_s = std::max(held_s, spikes.held_s);
    }
    THEN("it changes the velocity, after 20 ms at most") {
      CHECK(used_mps == Approx(2.0).margin(0.1));
      CHECK(held_s < 0.0205);
    }
  }
  GIVEN("readings that change by less than a body does in their interval") {
    SpikeFilter spikes;
    THEN("they are used at once") {
      const Vector3d reading_mps2{12.0, 0.0, 9.8};
      CHECK(spikes.add({0.0, 0.0, 9.8}, reading_mps2, 0.01, 20.0).reading_body == reading_mps2);
      const Vector3d fast_mps2{30.0, 0.0, 9.8};
      CHECK(spikes.add({0.0, 0.0, 9.8}, fast_mps2, 0.02, 20.0).reading_body == fast_mps2);
    }
  }
  GIVEN("a wrong reading that comes first with the stamp of the reading before") {
    const Vector3d usual_mps2{0.0, 0.0, 9.8};
    const Vector3d wrong_mps2{150.0, 0.0, 9.8};
    SpikeFilter spikes;
    CHECK(spikes.add(usual_mps2, wrong_mps2, 0.0, 20.0).reading_body == usual_mps2);
    THEN("it is held back at the next stamp too, and dropped") {
      CHECK(spikes.add(usual_mps2, wrong_mps2, 0.01, 20.0).reading_body == usual_mps2);
      CHECK(spikes.add(usual_mps2, usual_mps2, 0.01, 20.0).dropped_body.x() > 1.0);
    }
  }
  GIVEN("a reading that is held back, and another one of the same time") {
    SpikeFilter spikes;
    const Vector3d usual_mps2{0.0, 0.0, 9.8};
    const Vector3d reading_mps2{50.0, 0.0, 9.8};
    Vector3d made_up_mps = Vector3d::Zero();
    for (const double step_s : {0.01, 0.0, 0.02, 0.0, 0.02}) {
      made_up_mps += spikes.add(usual_mps2, reading_mps2, step_s, 20.0).made_up_body;
    }
    THEN("it is made up for") {
      CHECK((made_up_mps - Vector3d(1.5, 0.0, 0.0)).norm() < 1e-9);
    }
  }
}

SCENARIO("a vibration keeps its integral") {
  GIVEN("an accelerometer that vibrates from some moment on") {
    const double rate_hz = GENERATE(25.0, 100.0, 1000.0);
    const double share_of_rate = GENERATE(0.15, 0.2, 0.3, 0.4, 0.48, 0.5);
    const double amplitude_mps2 = GENERATE(12.0, 25.0, 60.0);
    const bool is_sudden = GENERATE(true, false);
    CAPTURE(rate_hz, share_of_rate, amplitude_mps2, is_sudden);
    SpikeFilter spikes;
    Vector3d last_mps2 = Vector3d::Zero();
    double used_mps = 0.0;
    double true_mps = 0.0;
    const auto count = static_cast<int>(20 * rate_hz);
    for (int k = 0; k < count; ++k) {
      const double growth = is_sudden ? 1.0 : std::min(1.0, k / (0.25 * count));
      const double phase = 2.0 * std::numbers::pi * share_of_rate * k + 0.5;
      const Vector3d reading_mps2{growth * amplitude_mps2 * std::cos(phase), 0.0, 0.0};
      const auto output = spikes.add(last_mps2, reading_mps2, 1.0 / rate_hz, 20.0);
      used_mps += output.reading_body.x() / rate_hz + output.made_up_body.x();
      true_mps += reading_mps2.x() / rate_hz;
      last_mps2 = output.reading_body;
    }
    THEN("at most its first moment is lost") {
      CHECK(std::abs(used_mps - true_mps) < amplitude_mps2 * 0.045);
    }
  }
}

SCENARIO("a gyroscope at the end of its range misses a part of the rate") {
  GIVEN("a turn about Z that exceeds the range") {
    constexpr double range_radps = 6.0;
    ClipDetector clip;
    CHECK(clip.add({0.1, 0.2, 5.9}).isZero());
    THEN("the first reading at the largest value may be right, and repeated ones miss something about Z") {
      CHECK(clip.add({0.1, 0.2, range_radps}).isZero());
      CHECK(clip.add({0.2, 0.1, range_radps}).isZero());
      const Vector3d missed_radps = clip.add({0.1, 0.3, range_radps});
      CHECK(missed_radps.x() == 0.0);
      CHECK(missed_radps.y() == 0.0);
      CHECK(missed_radps.z() > 0.5);
      AND_THEN("a smaller reading is right again") {
        CHECK(clip.add({0.1, 0.2, 5.8}).isZero());
      }
    }
  }
  GIVEN("a gyroscope at rest whose noise is below its resolution") {
    ClipDetector clip;
    THEN("its constant readings miss nothing") {
      for (int i = 0; i < 100; ++i) CHECK(clip.add({0.0, 0.01, -0.01}).isZero());
    }
  }
}

SCENARIO("a sample that comes again and again is a repetition only from a sensor with noise") {
  std::mt19937 random{5};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
  std::normal_distribution<double> noise(0.0, 0.01);
  const auto noise3 = [&] { return Vector3d(noise(random), noise(random), noise(random)); };
  RepeatDetector repeats;
  ImuMeasurement last;
  /// Number of repetitions among samples of which each comes `copies` times.
  const auto repetitions_in = [&](int samples, int copies, double gyro_step_radps) {
    int count = 0;
    for (int i = 0; i < samples; ++i) {
      ImuMeasurement sample = last;
      if (i % copies == 0) {
        sample.rate_body_radps = Vector3d(0.1, 0.2, 0.3) + noise3();
        if (gyro_step_radps > 0.0) {
          sample.rate_body_radps =
              (sample.rate_body_radps / gyro_step_radps).array().round() * gyro_step_radps;
        }
        sample.force_body_mps2 = Vector3d(1.0, 2.0, 9.0) + noise3();
      }
      if (repeats.repeats_with(last, sample)) ++count;
      repeats.add(last, sample);
      last = sample;
    }
    return count;
  };
  GIVEN("an IMU with noise") {
    CHECK(repetitions_in(200, 1, 0.0) == 0);
    WHEN("it sends one sample ten times, and then goes on") {
      THEN("the last six copies are repetitions") {
        CHECK(repetitions_in(10, 10, 0.0) == 6);
        CHECK(repetitions_in(200, 1, 0.0) == 0);
      }
    }
    WHEN("it sends each sample twice") {
      THEN("there is no repetition") {
        CHECK(repetitions_in(400, 2, 0.0) == 0);
      }
    }
  }
  GIVEN("an IMU that is read eight times as often as it measures") {
    THEN("its equal samples are usual") {
      CHECK(repetitions_in(1600, 8, 0.0) == 0);
    }
  }
  GIVEN("a gyroscope with steps far above its noise") {
    CHECK(repetitions_in(400, 1, 0.1) == 0);
    THEN("equal samples show nothing") {
      CHECK(repetitions_in(10, 10, 0.1) == 0);
    }
  }
}

SCENARIO("the roughness of the readings gives the density of their noise") {
  const double rate_hz = GENERATE(100.0, 1000.0);
  GIVEN("white noise of 3 m/s² at " + std::to_string(rate_hz) + " Hz") {
    std::mt19937 random{3};  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same numbers in every run
    std::normal_distribution<double> normal(0.0, 3.0);
    ShockDetector shocks;
    double mean_rthz = 0.0;
    constexpr int counted = 10000;
    for (int i = -counted; i < counted; ++i) {
      shocks.add({normal(random), normal(random), normal(random)}, 1.0 / rate_hz, 2.5);
      if (i >= 0) mean_rthz += shocks.density_rthz() / counted;
    }
    THEN("it is the deviation over the root of the rate") {
      CHECK(mean_rthz == Approx(3.0 / std::sqrt(rate_hz)).epsilon(0.2));
    }
  }
}

}  // namespace kalman_imu_steps_test
