/// Presets and the 37 items of the settings document. The documented engine reads all of them, the Kalman
/// engine those of hardware and policy. It ignores the others.

#include "config/beacon_settings.hpp"
#include "fusion/estimators_feeder.hpp"
#include "sim/simulator.hpp"
#include "support/poses_of.hpp"
#include <sonopose/settings/preset.hpp>
#include <sonopose/settings/settings_table.hpp>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace items_test {

using namespace sonopose;
using Catch::Contains;
using config::Assignments;
using settings::EngineKind;
using settings::ReadBy;
using settings::Settings;

struct Assignment {
  std::string_view key;
  std::string_view value;
};

/// An item with a non-default value, the settings that make it effective, and a scenario that shows its
/// effect.
struct Item {
  int number;
  std::string_view value;
  std::string_view scenario = "outlier_bursts";
  std::vector<Assignment> with = {};
};

std::vector<Item> items() {
  const std::vector<Assignment> user{{"documented.imu_weight", "user"}};
  const std::vector<Assignment> mahony{{"documented.attitude.filter", "mahony"}};
  const std::vector<Assignment> slow{{"documented.velocity.snap_min_speed_mps", "0.05"}};
  return {
      {1, "high"},
      {2, "0.9", "outlier_bursts", user},
      {3, "0.3", "outlier_bursts", user},
      {4, "0.7", "outlier_bursts", user},
      {5, "90"},
      {6, "false"},
      {7, "false", "drifting_tracks", slow},
      {8, "false", "drifting_tracks", slow},
      {9, "25"},
      {10, "5", "outages"},
      {11, "1.5", "outages"},
      {12, "80", "low_quality"},
      {13, "0.07"},
      {14, "0.2"},
      {15, "false"},
      {16, "0.3"},
      {17, "12"},
      {18, "5"},
      {19, "16", "outlier_bursts", {{"documented.trust.n_base", "30"}, {"documented.trust.stuck_n", "15"}}},
      {20, "3"},
      {21, "0.9", "relocation"},
      {22, "0.9", "relocation"},
      {23, "0.1", "outages"},
      {24, "9", "outages", {{"documented.runaway.position_error_m", "0.1"}}},
      {25, "2", "kart"},
      {26, "true"},
      {27, "1", "outlier_bursts", {{"documented.velocity.accel_gate", "true"}}},
      {28, "0.05", "drifting_tracks"},
      {29, "0.9", "outlier_bursts", mahony},
      {30, "0.009", "outlier_bursts", mahony},
      {31, "1", "no_heading"},
      {32, "0.02", "no_heading"},
      {33, "0.9", "no_heading"},
      {34, "3"},
      {35, "false", "spin"},
      {36, "0.5", "spin", {{"documented.motion.gyro_gate", "true"}}},
      {37,
       "2",
       "spin",
       {{"documented.motion.gyro_gate", "true"}, {"documented.motion.gyro_gate_projection_radps", "1"}}}};
}

const settings::SettingInfo& row_of(int item) {
  for (const auto& row : settings::setting_table()) {
    if (row.item == item) return row;
  }
  FAIL("no item " << item);
  throw std::logic_error("not reached");
}

void assign(Settings& settings, std::string_view key, std::string_view value) {
  settings::set(settings, key, settings::parse_value(key, value));
}

Settings settings_with(EngineKind engine, const std::vector<Assignment>& assignments) {
  Settings settings;
  settings.engine.engine = engine;
  for (const Assignment& each : assignments) assign(settings, each.key, each.value);
  return settings;
}

/// A cached run of 40 s.
const std::vector<Event>& run_of(std::string_view scenario) {
  static std::map<std::string_view, std::vector<Event>> runs;
  auto& run = runs[scenario];
  if (run.empty()) run = sim::record(sim::find_scenario(scenario), {.seed = 2, .duration_s = 40.0}).events;
  return run;
}

std::vector<FusedPose> poses_of(const Settings& settings, std::string_view scenario) {
  estimation::AnyEstimator estimator{settings};
  return sonopose::test::poses_of(estimator, run_of(scenario));
}

/// Settings before and after the item is changed.
struct Change {
  Settings before;
  Settings after;
  Assignments given;  ///< assignments of the user
};

Change change_of(const Item& item, EngineKind engine) {
  const settings::SettingInfo& row = row_of(item.number);
  Change change;
  change.before = settings_with(engine, item.with);
  change.after = change.before;
  assign(change.after, row.key, item.value);
  REQUIRE(settings::get(change.after, row.key) != settings::get(change.before, row.key));
  change.given.emplace(row.key, settings::get(change.after, row.key));
  if (engine == EngineKind::documented) {
    for (const Assignment& each : item.with) {
      change.given.emplace(each.key, settings::get(change.after, each.key));
    }
  }
  return change;
}

/// Poses without the change, cached for items with the same scenario and settings.
const std::vector<FusedPose>& poses_before(const Item& item, const Change& change) {
  static std::map<std::string, std::vector<FusedPose>> made;
  std::string key(item.scenario);
  key += change.before.engine.engine == EngineKind::kalman ? " kalman" : " documented";
  for (const Assignment& each : item.with) key += fmt::format(" {}={}", each.key, each.value);
  auto& poses = made[key];
  if (poses.empty()) poses = poses_of(change.before, item.scenario);
  return poses;
}

bool changes_poses(const Item& item, const Change& change) {
  return !fusion::test::same(poses_before(item, change), poses_of(change.after, item.scenario));
}

TEST_CASE("the documented engine reads each of the 37 items, without a warning") {
  const auto all = items();
  REQUIRE(all.size() == 37);
  for (const Item& item : all) {
    CAPTURE(item.number, row_of(item.number).key);
    const Change change = change_of(item, EngineKind::documented);
    CHECK(config::warnings_for(change.after, change.given).empty());
    CHECK(changes_poses(item, change));
  }
}

TEST_CASE("the Kalman engine reads items 5, 6, 11 and 12; any other changes nothing, with a warning") {
  const std::set<int> read{5, 6, 11, 12};
  for (const Item& item : items()) {
    const std::string key = row_of(item.number).key;
    CAPTURE(item.number, key);
    const Change change = change_of(item, EngineKind::kalman);
    CHECK(config::warnings_for(change.after, change.given).empty() == read.contains(item.number));
    CHECK((row_of(item.number).read_by == ReadBy::all) == read.contains(item.number));
    CHECK(changes_poses(item, change) == read.contains(item.number));
  }
}

TEST_CASE("item 1: each preset is resolved and replays; user at the defaults is medium") {
  std::map<std::string, std::vector<FusedPose>> poses;
  for (const std::string preset : {"low", "medium", "high", "user"}) {
    CAPTURE(preset);
    const Settings settings = settings_with(EngineKind::documented, {{"documented.imu_weight", preset}});
    CHECK(config::warnings_for(settings, {{"documented.imu_weight", preset}}).empty());
    const auto balance = settings::balance_of(settings.preset.imu_weight);
    const Settings used = estimation::AnyEstimator{settings}.settings();
    CHECK(used.drift.decay_rate_hz == balance.decay_rate_hz);
    CHECK(used.velocity.blend_weight == balance.blend_weight);
    CHECK(used.drift.jump_alpha == balance.jump_alpha);
    poses[preset] = poses_of(settings, "walk");
    CHECK(poses[preset].size() == 4000);
    for (const FusedPose& pose : poses[preset]) REQUIRE(pose.position_world_m.allFinite());
    CHECK((poses[preset].back().status & (status_initialising | status_stale)) == 0);
  }
  CHECK_FALSE(fusion::test::same(poses["low"], poses["medium"]));
  CHECK_FALSE(fusion::test::same(poses["medium"], poses["high"]));
  CHECK(fusion::test::same(poses["medium"], poses["user"]));
}

}  // namespace items_test
