/// A body that stays in a horizontal plane, in both engines (motion.planar).

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/aiding/height_check.hpp>
#include <sonopose/estimation/aiding/planar.hpp>
#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/prediction.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace planar_test {

using namespace sonopose;
using settings::EngineKind;

constexpr double forklift_height_m = 1.5;

settings::Settings planar(EngineKind engine, double height_m = forklift_height_m) {
  settings::Settings settings;
  settings.engine.engine = engine;
  settings.planar.planar = true;
  settings.planar.height_m = height_m;
  return settings;
}

/// Beacons at one height: the height of the fixes has this noise, in units of the others' 2 cm.
sim::Scenario forklift(double height_noise_factor) {
  sim::Scenario scenario = sim::find_scenario("forklift");
  scenario.sensors.fix_noise_m = {0.02, 0.02};
  scenario.sensors.fix_noise_factor = {1.0, 1.0, height_noise_factor};
  return scenario;
}

/// Poses at the IMU samples, and the truth at the same times.
struct Drive {
  std::vector<FusedPose> poses;
  std::vector<TruthSample> truth;

  Drive(const sim::Scenario& scenario, const settings::Settings& settings, double duration_s = 60.0,
        std::uint64_t seed = 1) {
    sim::Simulator simulator(scenario, {.seed = seed, .duration_s = duration_s});
    estimation::AnyEstimator estimator(settings);
    while (const auto step = simulator.next()) {
      std::visit(
          [&](const auto& sample) {
            if constexpr (std::is_same_v<std::remove_cvref_t<decltype(sample)>, ImuSample>) {
              const auto pose = estimator.predict(sample);
              estimator.finish_pending_work();
              if (!pose || !step->truth) return;
              poses.push_back(*pose);
              truth.push_back(*step->truth);
            } else {
              estimator.correct(sample);
            }
          },
          step->event);
    }
  }

  /// Calls `use` with each pose and truth from this time on.
  template <class Use>
  void from(double time_s, const Use& use) const {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (seconds_between(truth.front().time_ns, truth[i].time_ns) >= time_s) use(poses[i], truth[i]);
    }
  }

  [[nodiscard]] double max_height_error_m(double from_s) const {
    double max_m = 0.0;
    from(from_s, [&](const FusedPose& pose, const TruthSample& true_state) {
      max_m = std::max(max_m, std::abs(pose.position_world_m.z() - true_state.position_world_m.z()));
    });
    return max_m;
  }

  [[nodiscard]] double horizontal_rmse_m(double from_s) const {
    double sum_m2 = 0.0;
    int count = 0;
    from(from_s, [&](const FusedPose& pose, const TruthSample& true_state) {
      sum_m2 += (pose.position_world_m - true_state.position_world_m).head<2>().squaredNorm();
      ++count;
    });
    return std::sqrt(sum_m2 / count);
  }
};

SCENARIO("beacons at one height cost a planar body nothing") {
  GIVEN("fixes whose height has a noise of 0.5 m, and the same without it") {
    const auto engine = GENERATE(EngineKind::kalman, EngineKind::documented);
    const Drive noisy(forklift(25.0), planar(engine));
    const Drive exact(forklift(0.0), planar(engine));
    THEN("their heights do not matter, to the bit") {
      REQUIRE(noisy.poses.size() == exact.poses.size());
      for (std::size_t i = 0; i < noisy.poses.size(); ++i) {
        CHECK(noisy.poses[i].position_world_m == exact.poses[i].position_world_m);
      }
    }
    THEN("x and y are as good as those of three-dimensional fixes, and the height is the given one") {
      settings::Settings spatial = planar(engine);
      spatial.planar.planar = false;
      const Drive with_good_heights(forklift(1.0), spatial);
      CHECK(noisy.horizontal_rmse_m(6.0) < 1.1 * with_good_heights.horizontal_rmse_m(6.0));
      CHECK(noisy.max_height_error_m(6.0) < (engine == EngineKind::kalman ? 0.06 : 0.3));
    }
  }
  GIVEN("a floor whose height is unknown") {
    settings::Settings settings = planar(EngineKind::kalman, 0.0);
    settings.planar.height_from = settings::HeightSource::fixes;
    THEN("that of the fixes is averaged") {
      const Drive drive(forklift(25.0), settings, 120.0);
      CHECK(drive.max_height_error_m(60.0) < 0.25);  // half of one fix's standard deviation
    }
  }
}

SCENARIO("a planar body stays in its plane without fixes") {
  GIVEN("an outage of 20 s") {
    sim::Scenario scenario = forklift(1.0);
    scenario.disturbances.outages = {{30.0, 20.0}};
    THEN("height and tilt stay within what the settings state") {
      const Drive drive(scenario, planar(EngineKind::kalman));
      drive.from(6.0, [](const FusedPose& pose, const TruthSample& truth) {
        const settings::PlanarSettings stated;
        const double height_m = std::abs(pose.position_world_m.z() - truth.position_world_m.z());
        const double up = (pose.q_body_to_world * Vector3d::UnitZ()).z();
        CHECK(height_m < 4.0 * stated.height_std_m);
        CHECK(std::acos(std::min(up, 1.0)) < 4.0 * stated.tilt_std_deg * geometry::radians_per_degree);
      });
    }
  }
}

SCENARIO("the covariance includes the stated unevenness of the floor") {
  GIVEN("a circle on a floor that rises and falls by 15 cm, up to 1.1°") {
    constexpr double rise_m = 0.15;
    sim::Scenario scenario = sim::find_scenario("circle");
    scenario.sensors.fix_noise_factor = {1.0, 1.0, 25.0};
    const auto level = scenario.path;
    scenario.path = [level](double time_s) {
      sim::Path path = level(time_s);
      path.z = path.z + sim::Jet{rise_m} * sin(path.yaw);
      path.pitch = sim::Jet{-rise_m / 8.0} * cos(path.yaw);  // the radius is 8 m
      return path;
    };
    settings::Settings settings = planar(EngineKind::kalman, 0.2);
    settings.planar.height_std_m = rise_m;
    settings.planar.tilt_std_deg = 1.5;
    THEN("errors of the height are within three standard deviations, which are as stated") {
      const Drive drive(scenario, settings);
      drive.from(6.0, [](const FusedPose& pose, const TruthSample& truth) {
        const double std_m = pose.pose_covariance.std_dev(2);
        CHECK(std::abs(pose.position_world_m.z() - truth.position_world_m.z()) < 3.0 * std_m);
        CHECK(std_m > 0.8 * rise_m);
        CHECK(std_m < 1.5 * rise_m);
      });
    }
  }
}

SCENARIO("the output of a planar body can be flat") {
  GIVEN("a walk with steps and sway") {
    const auto engine = GENERATE(EngineKind::kalman, EngineKind::documented);
    settings::Settings settings = planar(engine, 1.0);
    settings.planar.output_flat = true;
    THEN("height, roll, pitch and vertical speed are 0, and yaw is that without this") {
      const sim::Scenario walk = sim::find_scenario("walk");
      const Drive flat(walk, settings, 20.0);
      settings.planar.output_flat = false;
      const Drive whole(walk, settings, 20.0);
      REQUIRE(flat.poses.size() == whole.poses.size());
      for (std::size_t i = 0; i < flat.poses.size(); ++i) {
        const FusedPose& pose = flat.poses[i];
        CHECK(pose.position_world_m.z() == 0.0);
        CHECK(pose.velocity_world_mps.z() == 0.0);
        CHECK(pose.q_body_to_world.x() == 0.0);
        CHECK(pose.q_body_to_world.y() == 0.0);
        const FusedPose ahead = estimation::predicted(pose, 5'000'000);
        CHECK(ahead.position_world_m.z() == 0.0);
        CHECK(ahead.velocity_world_mps.z() == 0.0);
        CHECK(ahead.q_body_to_world.x() == 0.0);
        CHECK(ahead.q_body_to_world.y() == 0.0);
        CHECK(pose.position_world_m.x() == whole.poses[i].position_world_m.x());
        CHECK(geometry::yaw_of(pose.q_body_to_world) ==
              Approx(geometry::yaw_of(whole.poses[i].q_body_to_world)).margin(1e-9));
      }
    }
  }
}

SCENARIO("fixes far from the height of a planar body are named with the height to set") {
  estimation::aiding::HeightCheck check;
  settings::PlanarSettings settings{.planar = true, .height_m = 0.5};
  const auto feed = [&](double height_m, double scatter_m = 0.05) {
    for (int i = 0; i < 60; ++i) {
      UltrasonicFix fix;
      fix.position_world_m = {1.0, 2.0, height_m + (i % 2 == 0 ? scatter_m : -scatter_m)};
      fix.point_body_m = {0.0, 0.0, 0.25};
      check.on(settings, fix);
    }
  };
  GIVEN("a tag 0.25 m above the body, and fixes at 2.25 m") {
    feed(2.25);
    THEN("the body is at 2 m instead of 0.5 m") {
      const auto problem = check.problem();
      REQUIRE(problem);
      CHECK(problem->text == "the fixes are 1.50 m above motion.height_m");
      CHECK(problem->remedy == "set motion.height_m=2.00, or motion.height_from=fixes");
    }
    THEN("nothing is said once the height is set, or the fixes give it, or the body is not planar") {
      settings.height_m = 2.0;
      feed(2.25);
      CHECK_FALSE(check.problem());
      settings.height_m = 0.5;
      settings.height_from = settings::HeightSource::fixes;
      feed(2.25);
      CHECK_FALSE(check.problem());
      settings = {.height_m = 0.5};
      feed(2.25);
      CHECK_FALSE(check.problem());
    }
  }
  GIVEN("fixes below the plane") {
    feed(0.0);
    CHECK(check.problem().value().text == "the fixes are 0.75 m below motion.height_m");
  }
  GIVEN("fixes that scatter widely, as of beacons at one height, or are a little high") {
    feed(1.25, 1.0);
    CHECK_FALSE(check.problem());
    feed(0.95);
    CHECK_FALSE(check.problem());
  }
  GIVEN("fixes a little nearer than the limit") {
    feed(1.02);
    THEN("a problem that was known lasts until they are clearly nearer") {
      CHECK_FALSE(check.problem());
      CHECK(check.problem(true));
      feed(0.9);
      CHECK_FALSE(check.problem(true));
    }
  }
}

}  // namespace planar_test
