/// Simulated sensor errors have the configured size.

#include "sim/simulator.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace statistics_test {

using namespace sonopose;
using namespace sonopose::sim;

struct Statistics {
  std::vector<double> values;

  void add(double value) { values.push_back(value); }
  void add(const Vector3d& value) {
    for (const double x : value) add(x);
  }
  [[nodiscard]] double mean() const {
    double sum = 0;
    for (const double x : values) sum += x;
    return sum / static_cast<double>(values.size());
  }
  [[nodiscard]] double deviation() const {
    const double middle = mean();
    double sum = 0;
    for (const double x : values) sum += (x - middle) * (x - middle);
    return std::sqrt(sum / static_cast<double>(values.size()));
  }
};

Statistics of(const std::vector<double>& values) {
  return Statistics{values};
}

SCENARIO("the normal distribution is correct") {
  GIVEN("a hundred thousand numbers") {
    Random random(42);
    std::vector<double> values(100'000);
    double third = 0;
    double fourth = 0;
    int beyond_two_sigma = 0;
    for (double& x : values) {
      x = random.normal();
      third += x * x * x;
      fourth += x * x * x * x;
      if (std::abs(x) > 2.0) ++beyond_two_sigma;
    }
    THEN("mean, deviation, skew, kurtosis and tails are a Gaussian's") {
      CHECK(std::abs(of(values).mean()) < 4.0 / std::sqrt(1e5));
      CHECK(of(values).deviation() == Approx(1.0).epsilon(0.01));
      CHECK(std::abs(third / 1e5) < 0.05);
      CHECK(fourth / 1e5 == Approx(3.0).epsilon(0.03));
      CHECK(beyond_two_sigma / 1e5 == Approx(0.0455).epsilon(0.06));
    }
  }
}

SCENARIO("noise has the configured size") {
  GIVEN("200 s at rest, with nothing but white noise and jitter") {
    SensorSettings settings;
    settings.accel_bias_mps2 = 0;
    settings.gyro_bias_radps = 0;
    settings.accel_bias_walk_mps2_rts = 0;
    settings.gyro_bias_walk_radps_rts = 0;
    settings.imu_quantised = false;
    constexpr double fix_rate_hz = 12.0;
    constexpr double fix_noise_m = 0.02;
    settings.fix_rate_hz = fix_rate_hz;
    settings.fix_noise_m = fix_noise_m;
    const Scenario& rest = find_scenario("rest");
    Simulator simulator(rest, settings, {.seed = 3, .duration_s = 200.0});
    const Motion truth = rest.motion(0);
    Statistics accel;
    Statistics gyro;
    Statistics position;
    Statistics heading;
    Statistics delay;
    Statistics quality;
    while (const auto step = simulator.next()) {
      if (const auto* imu = std::get_if<ImuSample>(&step->event)) {
        accel.add(imu->specific_force_body_mps2 - Vector3d(0, 0, 9.80665));
        gyro.add(imu->angular_velocity_body_radps);
      } else if (const auto* fix = std::get_if<UltrasonicFix>(&step->event)) {
        position.add(fix->position_world_m - truth.position_world_m);
        delay.add(seconds_between(fix->emission_time_ns, fix->received_time_ns));
        quality.add(*fix->quality_percent);
      } else {
        heading.add(std::get<PairHeading>(step->event).heading_world_rad -
                    geometry::yaw_of(truth.q_body_to_world));
      }
    }
    THEN("each spread is the setting's, and each mean is the truth") {
      CHECK(accel.deviation() == Approx(settings.accel_noise_mps2).epsilon(0.02));
      CHECK(gyro.deviation() == Approx(settings.gyro_noise_radps).epsilon(0.02));
      CHECK(position.deviation() == Approx(fix_noise_m).epsilon(0.05));
      CHECK(heading.deviation() == Approx(settings.heading_noise_rad).epsilon(0.06));
      CHECK(delay.deviation() == Approx(settings.fix_delay_jitter_s).epsilon(0.06));
      CHECK(std::abs(accel.mean()) < 4 * settings.accel_noise_mps2 / std::sqrt(6e4));
      CHECK(std::abs(gyro.mean()) < 4 * settings.gyro_noise_radps / std::sqrt(6e4));
      CHECK(std::abs(position.mean()) < 4 * fix_noise_m / std::sqrt(7200.0));
      CHECK(std::abs(heading.mean()) < 4 * settings.heading_noise_rad / std::sqrt(2400.0));
      CHECK(delay.mean() == Approx(0.068).margin(4 * settings.fix_delay_jitter_s / std::sqrt(2400.0)));
      CHECK(quality.mean() == Approx(settings.quality_percent).margin(0.3));
    }
    THEN("the rates are the settings'") {
      CHECK(accel.values.size() == 60'000U);
      CHECK(delay.values.size() == Approx(200.0 * fix_rate_hz).margin(2.0));
      CHECK(heading.values.size() == delay.values.size());
    }
  }
}

SCENARIO("biases differ between seeds and walk with the root of time") {
  GIVEN("300 seeds at rest, without white noise") {
    SensorSettings settings = SensorSettings::ideal();
    settings.gyro_bias_radps = 0.01;
    settings.gyro_bias_walk_radps_rts = 0.003;
    settings.accel_bias_mps2 = 0.03;
    settings.accel_bias_walk_mps2_rts = 0.01;
    settings.imu_rate_hz = 20.0;
    settings.fix_rate_hz = 0.0;
    Statistics first_gyro;
    Statistics first_accel;
    Statistics grown_gyro;
    Statistics grown_accel;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      Simulator simulator(find_scenario("rest"), settings, {.seed = seed, .duration_s = 25.0});
      const auto first = std::get<ImuSample>(simulator.next()->event);
      auto last = first;
      while (const auto step = simulator.next()) last = std::get<ImuSample>(step->event);
      first_gyro.add(first.angular_velocity_body_radps);
      first_accel.add(first.specific_force_body_mps2 - Vector3d(0, 0, 9.80665));
      grown_gyro.add(last.angular_velocity_body_radps - first.angular_velocity_body_radps);
      grown_accel.add(last.specific_force_body_mps2 - first.specific_force_body_mps2);
    }
    THEN("25 s of walk are five times the walk of one") {
      CHECK(first_gyro.deviation() == Approx(0.01).epsilon(0.1));
      CHECK(first_accel.deviation() == Approx(0.03).epsilon(0.1));
      CHECK(grown_gyro.deviation() == Approx(0.015).epsilon(0.1));
      CHECK(grown_accel.deviation() == Approx(0.05).epsilon(0.1));
    }
  }
}

SCENARIO("the IMU is as coarse as the beacon's packet") {
  GIVEN("a noisy walk") {
    Simulator simulator(find_scenario("walk"), SensorSettings{}, {.seed = 5, .duration_s = 10.0});
    double worst_step = 0;
    while (const auto step = simulator.next()) {
      const auto* imu = std::get_if<ImuSample>(&step->event);
      if (imu == nullptr) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const double mg = imu->specific_force_body_mps2[axis] / 9.80665e-3;
        const double lsb = imu->angular_velocity_body_radps[axis] / (0.0175 * std::numbers::pi / 180.0);
        worst_step = std::max({worst_step, std::abs(mg - std::round(mg)), std::abs(lsb - std::round(lsb))});
      }
    }
    THEN("each value is a whole number of 1 mg and 0.0175 deg/s") {
      CHECK(worst_step < 1e-9);
    }
  }
  GIVEN("a rotation faster than 16 bits of 0.0175 deg/s") {
    Motion spin;
    spin.angular_velocity_body_radps = {0, 0, 25.0};
    SensorSettings settings = SensorSettings::ideal();
    settings.imu_quantised = true;
    THEN("the gyro clips near 10 rad/s") {
      const ImuSample imu = ImuModel(settings, Random(1)).measure(spin);
      CHECK(imu.angular_velocity_body_radps.z() == Approx(10.008).epsilon(1e-4));
    }
  }
}

}  // namespace statistics_test
