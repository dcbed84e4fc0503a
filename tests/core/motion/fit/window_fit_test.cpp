#include "motion/fit/window_fit.hpp"

#include "doctor/replayed.hpp"
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <random>

namespace window_fit_test {

using namespace sonopose;
using namespace sonopose::motion;
using namespace sonopose::motion::fit;
using namespace sonopose::doctor::test;

constexpr double degrees = geometry::radians_per_degree;

/// Samples that arrive within `window_s` from `begin_s`.
Window window_of(const std::vector<Event>& events, double begin_s, double window_s) {
  Window window;
  const TimeNs begin_ns = available_at_ns(events.front()) + to_ns(begin_s);
  for (const Event& event : events) {
    const double time_s = seconds_between(begin_ns, available_at_ns(event));
    if (time_s < 0 || time_s > window_s) continue;
    if (const auto* imu = std::get_if<ImuSample>(&event)) {
      window.imu.push_back(
          {imu->sensor_time_ns, imu->angular_velocity_body_radps, imu->specific_force_body_mps2});
    } else if (const auto* fix = std::get_if<UltrasonicFix>(&event)) {
      window.fixes.push_back({fix->emission_time_ns, fix->position_world_m});
    } else {
      const auto& heading = std::get<PairHeading>(event);
      window.headings.push_back({heading.emission_time_ns, heading.heading_world_rad});
    }
  }
  return window;
}

TEST_CASE("Mount and delay of a moving beacon are found in eight seconds") {
  std::mt19937 random(20260);
  std::uniform_real_distribution<double> mounts_rad(-3.1, 3.1);
  std::uniform_real_distribution<double> delays_s(-0.06, 0.06);
  std::uniform_real_distribution<double> begins_s(6.0, 20.0);
  for (const char* const scenario : {"walk", "forklift", "kart", "drone"}) {
    for (std::uint64_t seed = 1801; seed < 1804; ++seed) {
      const double mount_rad = mounts_rad(random);
      const double delay_s = delays_s(random);
      const double begin_s = begins_s(random);
      CAPTURE(scenario, seed, mount_rad / degrees, delay_s, begin_s);
      const auto events = events_of(scenario, seed, begin_s + 10, [&](sim::SensorSettings& sensors) {
        sensors.pair_mount_offset_rad = mount_rad;
        sensors.reported_delay_error_s = -delay_s;
      });
      const auto pieces = pieces_of(window_of(events, begin_s, 8.0));
      REQUIRE(pieces.size() == 1);
      const Piece& piece = pieces.front();
      CHECK(piece.residual_m < 0.04);
      REQUIRE(piece.mount_rad);
      CHECK(std::abs(geometry::wrap_angle(piece.mount_rad->value - mount_rad)) < 8 * degrees);
      CHECK(std::abs(piece.delay_s.value - delay_s) < std::max(0.015, 4 * piece.delay_s.std));
    }
  }
}

TEST_CASE("At rest, mount and delay are not known") {
  const auto pieces = pieces_of(window_of(events_of("rest", 1811, 20), 5, 8));
  REQUIRE(pieces.size() == 1);
  CHECK(pieces.front().span_m < 0.3);
  CHECK(pieces.front().delay_s.std > 0.05);
  CHECK(pieces.front().mount_rad->std > 30 * degrees);
}

TEST_CASE("Without headings there is no mount, and too few samples make no piece") {
  Window window = window_of(events_of("walk", 1812, 20), 5, 8);
  window.headings.clear();
  REQUIRE(pieces_of(window).size() == 1);
  CHECK_FALSE(pieces_of(window).front().mount_rad);
  window.fixes.resize(5);
  CHECK(pieces_of(window).empty());
  CHECK(pieces_of({}).empty());
  CHECK(pieces_of(window_of(events_of("walk", 1812, 20), 5, 1)).empty());
}

TEST_CASE("A long window is cut into pieces of about eight seconds") {
  CHECK(pieces_of(window_of(events_of("walk", 1813, 40), 5, 25)).size() == 3);
}

}  // namespace window_fit_test
