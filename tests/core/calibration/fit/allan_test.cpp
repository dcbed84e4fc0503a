#include "calibration/fit/allan.hpp"

#include "sim/random.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace allan_test {

using namespace sonopose;
using namespace sonopose::calibration;
using namespace sonopose::calibration::fit;

constexpr double period_s = 0.01;

/// White noise of a density in U/√Hz has a standard deviation of density/√period per sample.
std::vector<double> white(double density, std::size_t count, std::uint64_t seed) {
  sim::Random random(seed);
  std::vector<double> samples(count);
  for (double& sample : samples) sample = density / std::sqrt(period_s) * random.normal();
  return samples;
}

/// A random walk grows by walk·√period from one sample to the next.
std::vector<double> walk(double coefficient, std::size_t count, std::uint64_t seed) {
  sim::Random random(seed);
  std::vector<double> samples(count);
  double value = 0.0;
  for (double& sample : samples) sample = value += coefficient * std::sqrt(period_s) * random.normal();
  return samples;
}

std::vector<double> sum_of(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> sum(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) sum[k] = a[k] + b[k];
  return sum;
}

std::vector<ImuSample> uniform_samples(std::size_t count) {
  sim::Random random(7);
  std::vector<ImuSample> imu(count);
  for (std::size_t k = 0; k < count; ++k) {
    imu[k].sensor_time_ns = 1'000'000'000 + static_cast<TimeNs>(k) * to_ns(period_s);
    imu[k].angular_velocity_body_radps = 0.001 * random.normal_vector();
    imu[k].specific_force_body_mps2 = Vector3d(0, 0, 9.8) + 0.02 * random.normal_vector();
  }
  return imu;
}

TEST_CASE("the deviation by hand: a sample that alternates, and a ramp") {
  // Successive means of one sample differ by 2, so the deviation is 2/√2; means of two samples are equal.
  std::vector<double> alternating(300);
  for (std::size_t k = 0; k < alternating.size(); ++k) alternating[k] = k % 2 == 0 ? 1.0 : -1.0;
  const auto flat = allan_deviation(alternating, period_s);
  REQUIRE(flat.size() > 3);
  CHECK(flat[0].tau_s == Approx(0.01));
  CHECK(flat[0].deviation == Approx(std::sqrt(2.0)));
  CHECK(flat[1].tau_s == Approx(0.02));
  CHECK(flat[1].deviation == Approx(0.0).margin(1e-12));
  // A ramp of 3 U/s: means τ apart differ by 3·τ, so the deviation is 3·τ/√2.
  std::vector<double> ramp(900);
  for (std::size_t k = 0; k < ramp.size(); ++k) ramp[k] = 3.0 * period_s * static_cast<double>(k);
  for (const AllanPoint& point : allan_deviation(ramp, period_s)) {
    CHECK(point.deviation == Approx(3.0 * point.tau_s / std::sqrt(2.0)).epsilon(1e-9));
  }
}

TEST_CASE("cluster lengths are evenly spaced on a logarithmic scale and end where few clusters are left") {
  const auto curve = allan_deviation(white(1.0, 90'000, 1), period_s);
  CHECK(curve.front().tau_s == Approx(period_s));
  CHECK(curve.back().tau_s <= 100.0);
  CHECK(curve.back().tau_s > 85.0);
  for (std::size_t i = 1; i < curve.size(); ++i) CHECK(curve[i].tau_s > curve[i - 1].tau_s);
  CHECK(curve.size() < 90);
  CHECK(allan_deviation(std::vector<double>(20, 1.0), period_s).empty());
}

TEST_CASE("GIVEN white noise THEN its density comes out, and nothing else is seen") {
  const double density = 0.0002;
  int seen_else = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    const auto curve = allan_deviation(white(density, 100'000, seed), period_s);
    const auto numbers = allan_numbers(curve);
    // 100 000 samples determine it to a few per mille.
    REQUIRE(numbers.noise_density.has_value());
    CHECK(*numbers.noise_density == Approx(density).epsilon(0.02));
    seen_else += numbers.bias_instability.has_value() || numbers.rate_random_walk.has_value() ? 1 : 0;
    for (const AllanPoint& point : curve) {
      const double expected = density / std::sqrt(point.tau_s);
      CHECK(std::abs(point.deviation - expected) < 4.5 * point.relative_error * expected);
    }
  }
  CHECK(seen_else <= 1);
}

TEST_CASE("GIVEN a random walk THEN its coefficient comes out, and no white noise is seen") {
  const double coefficient = 0.003;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    const auto numbers = allan_numbers(allan_deviation(walk(coefficient, 200'000, seed), period_s));
    REQUIRE(numbers.rate_random_walk.has_value());
    CHECK(*numbers.rate_random_walk == Approx(coefficient).epsilon(0.1));
    CHECK_FALSE(numbers.noise_density.has_value());
  }
}

TEST_CASE("GIVEN white noise on a random walk THEN both are seen, and the floor lies between them") {
  const double density = 0.01;
  const double coefficient = 0.003;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    const std::size_t count = 1'000'000;
    const auto samples = sum_of(white(density, count, seed), walk(coefficient, count, seed + 100));
    const auto numbers = allan_numbers(allan_deviation(samples, period_s));
    REQUIRE(numbers.noise_density.has_value());
    CHECK(*numbers.noise_density == Approx(density).epsilon(0.03));
    REQUIRE(numbers.rate_random_walk.has_value());
    CHECK(*numbers.rate_random_walk == Approx(coefficient).epsilon(0.2));
    // σ² = N²/τ + K²·τ/3 is least at τ = √3·N/K: 5.8 s, where σ² = 2·N·K/√3.
    REQUIRE(numbers.bias_instability.has_value());
    const double floor = std::sqrt(2.0 * density * coefficient / std::sqrt(3.0));
    CHECK(*numbers.bias_instability == Approx(floor / 0.664).epsilon(0.1));
    CHECK(*numbers.bias_instability_tau_s == Approx(5.8).epsilon(0.6));
  }
}

TEST_CASE("a floor counts only where it stands out of the white noise by more than the curve's own error") {
  // σ² = 1/τ + τ/20 is least at τ = √20 s, where it is 1/√5 and the white noise alone 1/√20.
  for (const double relative_error : {0.02, 0.15}) {
    CAPTURE(relative_error);
    std::vector<AllanPoint> curve;
    for (double tau_s = 0.01; tau_s < 14.0; tau_s *= 1.1) {
      curve.push_back({tau_s, std::sqrt(1.0 / tau_s + tau_s / 20.0), relative_error});
    }
    const AllanNumbers numbers = allan_numbers(curve);
    CHECK(numbers.noise_density.value() == Approx(1.0).epsilon(0.02));
    const bool known_well = relative_error < 0.1;
    CHECK(numbers.bias_instability.has_value() == known_well);
    if (known_well)
      CHECK(*numbers.bias_instability == Approx(std::sqrt(1.0 / std::sqrt(5.0)) / 0.664).epsilon(0.01));
    CHECK_FALSE(numbers.rate_random_walk.has_value());
  }
}

TEST_CASE("a record at rest is analysed axis by axis") {
  const auto report = analyse_allan(uniform_samples(20'000));
  CHECK(report.period_s == Approx(period_s));
  CHECK(report.duration_s == Approx(200.0));
  for (std::size_t axis = 0; axis < 6; ++axis) {
    CAPTURE(std::string(allan_axes[axis]));
    REQUIRE(report.numbers[axis].noise_density.has_value());
    // Noise per sample times √period.
    CHECK(*report.numbers[axis].noise_density == Approx(axis < 3 ? 0.0001 : 0.002).epsilon(0.05));
  }
}

TEST_CASE("too short a record, a gap, motion and a number that is none are refused with their place") {
  auto imu = uniform_samples(2000);
  CHECK_THROWS_WITH(analyse_allan(std::vector<ImuSample>(imu.begin(), imu.begin() + 999)),
                    Catch::Contains("999 samples") && Catch::Contains("1000"));
  auto gap = imu;
  for (std::size_t k = 700; k < gap.size(); ++k) gap[k].sensor_time_ns += to_ns(0.35);
  CHECK_THROWS_WITH(analyse_allan(gap), Catch::Contains("sample 701") && Catch::Contains("0.36 s"));
  auto back = imu;
  back[10].sensor_time_ns -= to_ns(0.02);
  CHECK_THROWS_WITH(analyse_allan(back), Catch::Contains("sample 11"));
  auto turned = imu;
  for (std::size_t k = 900; k < 1300; ++k) turned[k].angular_velocity_body_radps.z() += 0.5;
  CHECK_THROWS_WITH(analyse_allan(turned), Catch::Contains("at rest for") && Catch::Contains("90 %"));
  imu[1500].angular_velocity_body_radps.y() = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(analyse_allan(imu), Catch::Contains("sample 1501") && Catch::Contains("not finite"));
}

}  // namespace allan_test
