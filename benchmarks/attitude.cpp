// Update time of every attitude filter in ns, and its ratio to the plain Mahony filter (double, without
// magnetometer). Short rounds of all filters are interleaved, so that other load affects all of them equally.

#include "statistics.hpp"
#include <sonopose/attitude/adaptive.hpp>
#include <sonopose/attitude/ahrs.hpp>
#include <sonopose/attitude/complementary.hpp>
#include <sonopose/attitude/gyro.hpp>
#include <sonopose/attitude/mahony.hpp>
#include <sonopose/samples/samples.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace {

using namespace sonopose;
using attitude::Measurement;
using benchmarks::median;

/// Number of samples that fits into the L2 cache (300 kB in double).
constexpr std::size_t sample_count = 2400;

/// The motion of a hand-held body: 4 s of rest, then rotation about all axes at up to 5 rad/s and
/// acceleration of up to 4 m/s². The amplitude rises and falls, so the motion can be repeated.
struct Motion {
  static constexpr double rest_s = 4.0;
  static constexpr double length_s = 24.0;

  static double envelope(double time_s) {
    if (time_s < rest_s) return 0.0;
    const double half = std::sin(std::numbers::pi * (time_s - rest_s) / (length_s - rest_s));
    return half * half;
  }
  static double wave(double time_s, double frequency_hz) {
    return envelope(time_s) * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s);
  }
  static Quaterniond q_body_to_world(double time_s) {
    return geometry::rotation_of(geometry::EulerAngles<double>{
        0.8 * wave(time_s, 0.6), 0.6 * wave(time_s, 0.9), 1.2 * wave(time_s, 0.4)});
  }
  static Vector3d position_world_m(double time_s) {
    return {0.15 * wave(time_s, 0.8), 0.1 * wave(time_s, 0.7), 0.05 * wave(time_s, 1.1)};
  }
  static Vector3d acceleration_world_mps2(double time_s) {
    constexpr double h = 1e-3;
    return (position_world_m(time_s + h) - 2.0 * position_world_m(time_s) + position_world_m(time_s - h)) /
           (h * h);
  }
  /// Returns the magnetic field, disturbed for two seconds.
  static Vector3d field_world_t(double time_s) {
    const Vector3d earth_t(0.0, 20e-6, -45e-6);
    const bool disturbed = time_s > 14.0 && time_s < 16.0;
    return disturbed ? Vector3d(earth_t + Vector3d(30e-6, 0.0, 10e-6)) : earth_t;
  }
};

/// Returns measurements of sensors with noise and a gyroscope offset, at steps of 8 to 12 ms.
std::vector<Measurement<double>> measure_motion() {
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  const auto shaken_by = [&](double deviation) -> Vector3d {
    return deviation * Vector3d(noise(random), noise(random), noise(random));
  };
  constexpr double mean_dt_s = Motion::length_s / sample_count;
  std::uniform_real_distribution<double> step_s(0.8 * mean_dt_s, 1.2 * mean_dt_s);
  std::vector<Measurement<double>> samples(sample_count);
  double time_s = 0.0;
  for (auto& sample : samples) {
    sample.dt_s = step_s(random);
    const Quaterniond q_before = Motion::q_body_to_world(time_s);
    time_s += sample.dt_s;
    const Quaterniond q = Motion::q_body_to_world(time_s);
    const Eigen::AngleAxisd turn(q_before.conjugate() * q);
    sample.angular_velocity_body_radps =
        turn.angle() / sample.dt_s * turn.axis() + Vector3d(0.005, -0.003, 0.004) + shaken_by(0.003);
    sample.specific_force_body_mps2 = q.conjugate() * (Motion::acceleration_world_mps2(time_s) +
                                                       standard_gravity_mps2 * Vector3d::UnitZ()) +
                                      shaken_by(0.05);
    sample.magnetic_field_body_t = q.conjugate() * Motion::field_world_t(time_s) + shaken_by(0.3e-6);
  }
  return samples;
}

template <class Scalar>
std::vector<Measurement<Scalar>> samples_of(int axes) {
  static const auto motion = measure_motion();
  std::vector<Measurement<Scalar>> samples;
  for (const auto& measured : motion) {
    Measurement<Scalar> sample;
    sample.dt_s = Scalar(measured.dt_s);
    sample.angular_velocity_body_radps = measured.angular_velocity_body_radps.cast<Scalar>();
    sample.specific_force_body_mps2 = measured.specific_force_body_mps2.cast<Scalar>();
    if (axes == 9) sample.magnetic_field_body_t = measured.magnetic_field_body_t.cast<Scalar>();
    samples.push_back(sample);
  }
  return samples;
}

/// A filter and its time per update in each round, ns.
struct Entry {
  std::string_view filter;
  int axes;
  bool is_double;
  std::function<void()> run_motion;
  std::vector<double> rounds_ns;

  void measure() {
    const auto begin = std::chrono::steady_clock::now();
    run_motion();
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - begin;
    rounds_ns.push_back(taken.count() / sample_count);
  }
};

/// Measures a filter, which keeps its state between rounds, as if the motion were repeated.
template <class Filter>
Entry entry_of(int axes) {
  using Scalar = typename Filter::Scalar;
  const auto run_motion = [filter = Filter(), settings = typename Filter::Settings(),
                           samples = samples_of<Scalar>(axes)]() mutable {
    for (const auto& sample : samples) filter.update(settings, sample);
    if (!filter.orientation().coeffs().allFinite()) throw std::runtime_error("a filter failed");
  };
  return {Filter::name, axes, std::is_same_v<Scalar, double>, run_motion, {}};
}

template <template <class> class Filter>
void add_each(std::vector<Entry>& entries) {
  for (const int axes : {6, 9}) {
    entries.push_back(entry_of<Filter<double>>(axes));
    entries.push_back(entry_of<Filter<float>>(axes));
  }
}

/// Returns the median ratio over the rounds.
double ratio(const Entry& entry, const Entry& reference) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < entry.rounds_ns.size(); ++i)
    ratios.push_back(entry.rounds_ns[i] / reference.rounds_ns[i]);
  return median(ratios);
}

void print_table(const std::vector<Entry>& entries) {
  const Entry& plain = entries.front();
  fmt::print("{:<14} {:>4}  {:<6} {:>6}  {:>12}  {:>24}\n", "filter", "axes", "number", "ns", "plain Mahony",
             "Mahony of the same kind");
  for (const Entry& entry : entries) {
    const auto alike = std::find_if(entries.begin(), entries.end(), [&entry](const Entry& mahony) {
      return mahony.axes == entry.axes && mahony.is_double == entry.is_double;
    });
    fmt::print("{:<14} {:>4}  {:<6} {:>6.1f}  {:>12.2f}  {:>24.2f}\n", entry.filter, entry.axes,
               entry.is_double ? "double" : "float", median(entry.rounds_ns), ratio(entry, plain),
               ratio(entry, *alike));
  }
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 501;
  CLI::App app("Update time of every attitude filter, and its ratio to the plain Mahony filter.",
               "benchmark_attitude");
  app.add_option("--rounds", rounds, "Rounds of each filter, 24 s of samples at 100 Hz in each")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::vector<Entry> entries;
  // Mahony comes first, as the reference for the others.
  add_each<attitude::BasicMahony>(entries);
  add_each<attitude::BasicComplementary>(entries);
  add_each<attitude::BasicAhrs>(entries);
  add_each<attitude::BasicGyro>(entries);
  add_each<attitude::BasicAdaptive>(entries);
  for (Entry& entry : entries) entry.run_motion();
  for (int round = 0; round < rounds; ++round) {
    for (Entry& entry : entries) entry.measure();
  }
  print_table(entries);
  return 0;
}
