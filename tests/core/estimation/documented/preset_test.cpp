/// Presets of the IMU's weight (item 1).

#include <sonopose/settings/preset.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>

#include <support/engine_driver.hpp>

namespace preset_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using namespace sonopose::settings;

struct Score {
  double distance_to_fixes_m;  ///< RMS distance of the pose from the fix just applied
  double roughness_m;          ///< RMS of the output's second difference
};

/// Scores a preset on a log with the same motion and noise for all.
Score score_of(ImuWeight weight) {
  Settings settings;
  settings.preset.imu_weight = weight;
  test::Sensors sensors;
  sensors.noise_m = 0.02;
  test::EngineDriver driver(settings, test::departure(1.5, 0.3), sensors);
  driver.run(40.0);

  double distances = 0.0;
  int fixes = 0;
  for (const auto& report : driver.reports) {
    const double time_s = seconds_between(test::epoch_ns, report.applied_time_ns);
    const auto next = static_cast<std::size_t>(std::lround(time_s * 100.0)) + 1;
    if (time_s < 5.0 || next >= driver.moments.size()) continue;
    const auto& moment = driver.moments[next];
    const Vector3d fix_now_world_m =
        report.shifted_position_world_m + (moment.time_s - time_s) * moment.truth.velocity_world_mps;
    distances += (fix_now_world_m - moment.pose.position_world_m).squaredNorm();
    ++fixes;
  }
  double bends = 0.0;
  int count = 0;
  for (std::size_t i = 502; i < driver.moments.size(); ++i) {
    const auto p = [&](std::size_t k) { return driver.moments[k].pose.position_world_m; };
    bends += (p(i) - 2.0 * p(i - 1) + p(i - 2)).squaredNorm();
    ++count;
  }
  return {std::sqrt(distances / fixes), std::sqrt(bends / count)};
}

TEST_CASE("item 1: on one log low is closest to the fixes and high is smoothest") {
  const Score low = score_of(ImuWeight::low);
  const Score medium = score_of(ImuWeight::medium);
  const Score high = score_of(ImuWeight::high);
  CHECK(low.distance_to_fixes_m < medium.distance_to_fixes_m);
  CHECK(medium.distance_to_fixes_m < high.distance_to_fixes_m);
  CHECK(low.roughness_m > medium.roughness_m);
  CHECK(medium.roughness_m > high.roughness_m);
}

TEST_CASE("item 1: a preset ignores the user's items 2, 3 and 4, user takes them") {
  Settings settings;
  settings.drift.decay_rate_hz = 9.5;
  settings.velocity.blend_weight = 0.9;
  settings.drift.jump_alpha = 0.95;
  for (const auto weight : {ImuWeight::low, ImuWeight::medium, ImuWeight::high}) {
    settings.preset.imu_weight = weight;
    const Settings used = Engine(settings).settings();
    const Balance balance = balance_of(weight);
    CHECK(used.drift.decay_rate_hz == balance.decay_rate_hz);
    CHECK(used.velocity.blend_weight == balance.blend_weight);
    CHECK(used.drift.jump_alpha == balance.jump_alpha);
    CHECK(used.drift.jump_alpha != 0.95);
  }
  settings.preset.imu_weight = ImuWeight::user;
  const Settings used = Engine(settings).settings();
  CHECK(used.drift.decay_rate_hz == 9.5);
  CHECK(used.velocity.blend_weight == 0.9);
  CHECK(used.drift.jump_alpha == 0.95);
}

TEST_CASE("item 1: a preset changes nothing else") {
  Settings settings;
  settings.preset.imu_weight = ImuWeight::low;
  settings.drift.velocity_smooth_rate_hz = 22.0;
  settings.velocity.snap_min_speed_mps = 3.3;
  const Settings used = resolved(settings);
  for (const auto& row : setting_table()) {
    const bool replaced = row.item == 2 || row.item == 3 || row.item == 4;
    if (!replaced) CHECK(get(used, row.key) == get(settings, row.key));
  }
}

TEST_CASE("item 1: medium equals the defaults of user") {
  const Settings medium = resolved(Settings{});
  Settings user;
  user.preset.imu_weight = ImuWeight::user;
  for (const auto& row : setting_table()) {
    if (row.item != 1) CHECK(get(medium, row.key) == get(resolved(user), row.key));
  }
}

}  // namespace preset_test
