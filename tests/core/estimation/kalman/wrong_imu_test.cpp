/// Sensors that violate the model: the engine detects and reports it.

#include "sim/scenario.hpp"
#include "sim/simulator.hpp"
#include <sonopose/estimation/estimator.hpp>
#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/geometry/rotation.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace kalman_wrong_imu_test {

using namespace sonopose;

constexpr double without_end_s = 1e6;

/// A pose's time and errors.
struct Moment {
  double time_s;
  FusedPose pose;
  double error_m;
  double yaw_error_rad;
};

std::vector<Moment> moments_of(
    const std::string& scenario, std::uint64_t seed, const std::function<void(sim::Scenario&)>& change,
    double duration_s = 40.0, const std::function<void(Event&)>& spoil = [](Event&) {}) {
  sim::Scenario changed = sim::find_scenario(scenario);
  change(changed);
  sim::Simulator simulator(changed, {.seed = seed, .duration_s = duration_s});
  estimation::kalman::Engine engine{settings::Settings{}};
  std::vector<Moment> moments;
  while (const auto step = simulator.next()) {
    Event event = step->event;
    spoil(event);
    const auto result = estimation::process(engine, event);
    const auto* pose = std::get_if<FusedPose>(&result);
    if (pose == nullptr || !step->truth) continue;
    moments.push_back({seconds_between(sim::Run{}.start_time_ns, pose->time_ns), *pose,
                       (pose->position_world_m - step->truth->position_world_m).norm(),
                       geometry::wrap_angle(geometry::yaw_of(pose->q_body_to_world) -
                                            geometry::yaw_of(step->truth->q_body_to_world))});
  }
  return moments;
}

/// Time at which the bit is first set; infinite if never.
double first_s(const std::vector<Moment>& moments, PoseStatus bit) {
  const auto has_bit = [&](const Moment& moment) { return (moment.pose.status & bit) != 0; };
  const auto found = std::find_if(moments.begin(), moments.end(), has_bit);
  return found == moments.end() ? std::numeric_limits<double>::infinity() : found->time_s;
}

double largest_error_m(const std::vector<Moment>& moments, double from_s) {
  double largest_m = 0.0;
  for (const Moment& moment : moments) {
    if (moment.time_s >= from_s) largest_m = std::max(largest_m, moment.error_m);
  }
  return largest_m;
}

SCENARIO("a vibrating vehicle finds its fixes again after a gap") {
  const std::string name = GENERATE("kart", "drone");
  const std::uint64_t seed = GENERATE(7101U, 7102U, 7103U);
  GIVEN("a " << name << " that vibrates, and no fixes for 2.5 s, seed " << seed) {
    const auto moments = moments_of(name, seed, [&](sim::Scenario& scenario) {
      scenario.disturbances.imu_faults = {
          {.begin_s = 5.0, .duration_s = without_end_s, .vibration_mps2 = 0.7}};
      scenario.disturbances.outages = {{.begin_s = 20.0, .duration_s = 2.5}};
    });
    THEN("it is within decimetres of the track a second later, and stays there") {
      CHECK(largest_error_m(moments, 23.5) < 0.3);
    }
  }
}

SCENARIO("single samples at the end of the range cost centimetres") {
  const std::string name = GENERATE("walk", "kart");
  const std::uint64_t seed = GENERATE(7101U, 7102U);
  const bool is_rate = GENERATE(true, false);
  GIVEN("a " << name << " with a sample of " << (is_rate ? "2000 °/s" : "16 g") << " every 3 s, seed "
             << seed) {
    int samples = 0;
    const auto spoil = [&](Event& event) {
      auto* const imu = std::get_if<ImuSample>(&event);
      if (imu == nullptr || ++samples % 300 != 0) return;
      if (is_rate) {
        imu->angular_velocity_body_radps.y() = -2000.0 * geometry::radians_per_degree;
      } else {
        imu->specific_force_body_mps2.x() = 157.0;
      }
    };
    const auto moments = moments_of(
        name, seed, [](sim::Scenario&) {}, 40.0, spoil);
    THEN("the position stays near the fixes, and no rate of that size is published") {
      CHECK(largest_error_m(moments, 6.0) < 0.15);
      const auto is_fast = [](const Moment& moment) {
        return moment.pose.angular_velocity_body_radps.norm() > 20.0;
      };
      CHECK(std::none_of(moments.begin(), moments.end(), is_fast));
    }
  }
}

SCENARIO("a sudden force that may be wrong makes the velocity uncertain at once, along its direction") {
  GIVEN("a walk with one sample of 16 g") {
    constexpr double at_s = 20.003;
    constexpr double force_mps2 = 157.0;
    bool is_done = false;
    const auto moments = moments_of(
        "walk", 7101, [](sim::Scenario&) {}, 21.0,
        [&](Event& event) {
          auto* const imu = std::get_if<ImuSample>(&event);
          if (imu == nullptr || is_done ||
              seconds_between(sim::Run{}.start_time_ns, imu->sensor_time_ns) < at_s)
            return;
          imu->specific_force_body_mps2.x() = force_mps2;
          is_done = true;
        });
    const auto velocity_std = [&](double time_s, const Vector3d& axis_body) {
      const auto moment = std::find_if(moments.begin(), moments.end(),
                                       [&](const Moment& each) { return each.time_s >= time_s; });
      REQUIRE(moment != moments.end());
      const Vector3d axis_world = moment->pose.q_body_to_world * axis_body;
      return std::sqrt(axis_world.dot(moment->pose.velocity_covariance.matrix() * axis_world));
    };
    THEN("two samples later half of its integral is the standard deviation along X") {
      const double integral_mps = 0.01 * force_mps2;
      CHECK(velocity_std(20.03, Vector3d::UnitX()) == Approx(0.5 * integral_mps).epsilon(0.2));
      CHECK(velocity_std(20.03, Vector3d::UnitY()) < 0.1 * integral_mps);
      CHECK(velocity_std(20.03, Vector3d::UnitZ()) < 0.1 * integral_mps);
    }
  }
}

SCENARIO("a gyro axis that dies or turns round while the body walks is found") {
  const double factor = GENERATE(0.0, -1.0);
  const std::uint64_t seed = GENERATE(7001U, 7002U, 7003U);
  constexpr double dies_s = 15.0;
  GIVEN("a gyro whose Z axis reads " << factor << " times the rate from some second on, seed " << seed) {
    const auto moments = moments_of("walk", seed, [&](sim::Scenario& scenario) {
      scenario.disturbances.imu_faults = {
          {.begin_s = dies_s, .duration_s = without_end_s, .gyro_factor = {1.0, 1.0, factor}}};
    });
    THEN("the status says so within five seconds, and not before") {
      CHECK(first_s(moments, status_imu_inconsistent) > dies_s);
      CHECK(first_s(moments, status_imu_inconsistent) < dies_s + 5.0);
    }
    THEN("the position stays within decimetres") {
      CHECK(largest_error_m(moments, 6.0) < 0.5);
    }
  }
}

SCENARIO("an IMU that turns in its mount is found, and trusted again") {
  const std::uint64_t seed = GENERATE(7061U, 7062U, 7063U);
  constexpr double turns_s = 15.0;
  GIVEN("a walk whose IMU tilts by 8 degrees at some second, seed " << seed) {
    const auto moments = moments_of("walk", seed, [&](sim::Scenario& scenario) {
      constexpr double turn_rad = 8.0 * geometry::radians_per_degree;
      scenario.disturbances.imu_faults = {
          {.begin_s = turns_s, .duration_s = without_end_s, .turned_by_rad = {turn_rad, 0.0, 0.0}}};
    });
    THEN("the status says so within five seconds, and not before") {
      CHECK(first_s(moments, status_imu_inconsistent) > turns_s);
      CHECK(first_s(moments, status_imu_inconsistent) < turns_s + 5.0);
    }
    THEN("the position stays within decimetres, and is soon as good as with a fixed IMU") {
      CHECK(largest_error_m(moments, 6.0) < 0.8);
      CHECK(largest_error_m(moments, turns_s + 10.0) < 0.1);
    }
  }
}

SCENARIO("an IMU that turns in its mount is found while the yaw is unknown") {
  const std::uint64_t seed = GENERATE(7071U, 7072U, 7073U);
  constexpr double turns_s = 15.0;
  GIVEN("a single beacon that sways from the start, and whose IMU turns by 12 degrees, seed " << seed) {
    const auto moments = moments_of("swaying", seed, [&](sim::Scenario& scenario) {
      constexpr double turn_rad = 12.0 * geometry::radians_per_degree;
      scenario.sensors.pair_heading = false;
      scenario.disturbances.imu_faults = {
          {.begin_s = turns_s, .duration_s = without_end_s, .turned_by_rad = {turn_rad, 0.0, 0.0}}};
    });
    THEN("the position stays within a metre, and is soon as good as that of the fixes") {
      CHECK(largest_error_m(moments, 6.0) < 1.0);
      CHECK(largest_error_m(moments, turns_s + 10.0) < 0.2);
    }
  }
}

SCENARIO("an accelerometer whose bias steps costs decimetres at most, and the covariance says so") {
  const std::uint64_t seed = GENERATE(7071U, 7072U, 7073U);
  const double step_mps2 = GENERATE(0.15, 0.3, 0.8);
  constexpr double steps_s = 15.0;
  GIVEN("a walk whose accelerometer reads " << step_mps2 << " m/s² too much from some second on, seed "
                                            << seed) {
    const auto moments = moments_of("walk", seed, [&](sim::Scenario& scenario) {
      scenario.disturbances.imu_faults = {
          {.begin_s = steps_s, .duration_s = without_end_s, .accel_offset_body_mps2 = {step_mps2, 0.0, 0.0}}};
    });
    THEN("the position stays within decimetres, although a wrong track would look the same at first") {
      CHECK(largest_error_m(moments, 6.0) < 0.5);
      CHECK(largest_error_m(moments, steps_s + 10.0) < 0.1);
    }
    THEN("less than one pose in a hundred is further off than five standard deviations") {
      const auto is_far_off = [](const Moment& moment) {
        return moment.time_s > 6.0 && moment.error_m > 5.0 * position_std_m(moment.pose).norm();
      };
      CHECK(std::count_if(moments.begin(), moments.end(), is_far_off) * 100 < std::ssize(moments));
    }
  }
}

SCENARIO("a gyroscope whose bias steps is followed within seconds, and the status says so") {
  const std::uint64_t seed = GENERATE(7121U, 7122U, 7123U, 7124U);
  const std::string motion = GENERATE("walk", "forklift");
  const double step_radps = GENERATE(0.02, 0.05, 0.1);
  constexpr double steps_s = 15.0;
  GIVEN("the scenario " << motion << " whose gyroscope reads " << step_radps
                        << " rad/s too much from some second on, seed " << seed) {
    const auto moments = moments_of(motion, seed, [&](sim::Scenario& scenario) {
      scenario.disturbances.imu_faults = {{.begin_s = steps_s,
                                           .duration_s = without_end_s,
                                           .gyro_offset_body_radps = Vector3d::Constant(step_radps)}};
    });
    THEN("position and yaw stay near, and are soon as good as before") {
      CHECK(largest_error_m(moments, 6.0) < 0.5);
      CHECK(largest_error_m(moments, steps_s + 10.0) < 0.12);
      for (const Moment& moment : moments) {
        if (moment.time_s < 6.0) continue;
        REQUIRE(std::abs(moment.yaw_error_rad) < 12.0 * geometry::radians_per_degree);
        if (moment.time_s < steps_s + 10.0) continue;
        REQUIRE(std::abs(moment.yaw_error_rad) < 3.0 * geometry::radians_per_degree);
      }
    }
    THEN("the status says so within five seconds, and not before") {
      const auto is_doubtful = [](const Moment& moment) {
        return moment.time_s > 6.0 && moment.pose.status != 0;
      };
      const auto found = std::find_if(moments.begin(), moments.end(), is_doubtful);
      REQUIRE(found != moments.end());
      CHECK(found->time_s > steps_s);
      CHECK(found->time_s < steps_s + 5.0);
    }
  }
}

SCENARIO("an accelerometer of another unit is found") {
  GIVEN("a walk with an accelerometer that counts in g") {
    const auto moments = moments_of("walk", 7011, [&](sim::Scenario& scenario) {
      scenario.disturbances.imu_faults = {
          {.duration_s = without_end_s, .accel_factor = Vector3d::Constant(1.0 / standard_gravity_mps2)}};
    });
    THEN("the status says so within five seconds") {
      CHECK(first_s(moments, status_imu_inconsistent) < 5.0);
    }
    THEN("the position is as good as that of the fixes") {
      CHECK(largest_error_m(moments, 10.0) < 0.4);
    }
  }
}

SCENARIO("clocks of IMU and fixes that differ are found, and the offset is taken back") {
  const double error_s = GENERATE(-0.2, -0.06, 0.06, 0.2);
  const std::uint64_t seed = GENERATE(7051U, 7052U);
  GIVEN("a kart whose fixes and headings report a delay that is wrong by " << error_s << " s, seed "
                                                                           << seed) {
    const auto moments = moments_of(
        "kart", seed, [&](sim::Scenario& scenario) { scenario.sensors.reported_delay_error_s = error_s; });
    THEN("the status says so within five seconds of motion") {
      CHECK(first_s(moments, status_fixes_inconsistent) < 10.0);
    }
    THEN("the position is as good as with one clock") {
      CHECK(largest_error_m(moments, 20.0) < 0.1);
    }
    THEN("the covariance covers the way in the offset, because the IMU's clock may be the wrong one") {
      const Moment& last = moments.back();
      const double way_m = std::abs(error_s) * last.pose.velocity_world_mps.norm();
      CHECK(position_std_m(last.pose).norm() > 0.8 * way_m);
    }
  }
}

SCENARIO("the yaw of a body that turns faster than its gyroscope measures is known to be uncertain") {
  const std::uint64_t seed = GENERATE(7111U, 7112U, 7113U);
  GIVEN("turns of 9 rad/s with a gyroscope that ends at 6 rad/s, seed " << seed) {
    const auto moments =
        moments_of("spin", seed, [](sim::Scenario& scenario) { scenario.sensors.gyro_limit_radps = 6.0; });
    THEN("the mean squared error of the yaw is about its variance, and headings soon correct it") {
      double normalised = 0.0;
      double squares_rad2 = 0.0;
      double count = 0.0;
      for (const Moment& moment : moments) {
        if (moment.time_s < 6.0) continue;
        count += 1.0;
        normalised += std::pow(moment.yaw_error_rad / yaw_std_rad(moment.pose), 2);
        squares_rad2 += std::pow(moment.yaw_error_rad, 2);
      }
      CHECK(normalised / count < 4.0);
      CHECK(std::sqrt(squares_rad2 / count) < 20.0 * geometry::radians_per_degree);
    }
    THEN("the position stays within decimetres") {
      CHECK(largest_error_m(moments, 6.0) < 0.3);
    }
  }
}

SCENARIO("a pair that is swapped for some seconds turns nothing") {
  const std::string motion = GENERATE("walk", "kart", "drone", "spin");
  GIVEN("the scenario " + motion + " with headings that are opposite for 2 and for 6 s") {
    const auto moments = moments_of(motion, 7081, [](sim::Scenario& scenario) {
      scenario.disturbances.heading_errors = {{12.0, 2.0, std::numbers::pi, true},
                                              {20.0, 6.0, std::numbers::pi, true}};
    });
    THEN("yaw and position are as before, and the IMU is not blamed") {
      for (const Moment& moment : moments) {
        if (moment.time_s < 6.0) continue;
        REQUIRE(std::abs(moment.yaw_error_rad) < 3.0 * geometry::radians_per_degree);
      }
      CHECK(largest_error_m(moments, 6.0) < 0.08);
      CHECK(std::isinf(first_s(moments, status_imu_inconsistent)));
    }
  }
}

SCENARIO("headings of a wrong mount are overruled by the motion") {
  const std::string name = GENERATE("walk", "kart");
  const double error_deg = GENERATE(20.0, -60.0);
  const std::uint64_t seed = GENERATE(7091U, 7092U);
  GIVEN("a " << name << " whose headings are all off by " << error_deg << " degrees, seed " << seed) {
    const auto moments = moments_of(name, seed, [&](sim::Scenario& scenario) {
      scenario.disturbances.heading_errors = {
          {0.0, without_end_s, error_deg * geometry::radians_per_degree, true}};
    });
    THEN("yaw and position are right after 15 s of motion") {
      for (const Moment& moment : moments) {
        if (moment.time_s > 18.0)
          REQUIRE(std::abs(moment.yaw_error_rad) < 6.0 * geometry::radians_per_degree);
      }
      CHECK(largest_error_m(moments, 18.0) < 0.1);
    }
  }
}

SCENARIO("a yaw that is off by a quarter or half turn is found from the motion") {
  const std::string name = GENERATE("moving_start", "hard_stops");
  const double error_deg = GENERATE(90.0, 180.0);
  GIVEN("a drive, " << name << ", whose headings are all off by " << error_deg << " degrees") {
    const auto moments = moments_of(
        name, 7093,
        [&](sim::Scenario& scenario) {
          scenario.disturbances.heading_errors = {
              {0.0, without_end_s, error_deg * geometry::radians_per_degree, true}};
        },
        60.0);
    THEN("it is right in the end") {
      for (const Moment& moment : moments) {
        if (moment.time_s > 45.0)
          REQUIRE(std::abs(moment.yaw_error_rad) < 6.0 * geometry::radians_per_degree);
      }
    }
  }
}

SCENARIO("fixes that scatter for some seconds, or repeat, cost decimetres at most") {
  const std::uint64_t seed = GENERATE(7101U, 7102U, 7103U);
  const bool repeats = GENERATE(false, true);
  GIVEN("a walk whose fixes " << (repeats ? "repeat for 2 s" : "scatter by 0.3 m for 8 s") << ", seed "
                              << seed) {
    const auto moments = moments_of("walk", seed, [&](sim::Scenario& scenario) {
      scenario.disturbances.fix_faults = {{.begin_s = 15.0,
                                           .duration_s = repeats ? 2.0 : 8.0,
                                           .noise_m = repeats ? 0.0 : 0.3,
                                           .repeats = repeats}};
    });
    THEN("the position stays within decimetres, and is right at once when they are") {
      CHECK(largest_error_m(moments, 6.0) < 0.5);
      CHECK(largest_error_m(moments, 25.0) < 0.08);
    }
  }
}

SCENARIO("a default position among the fixes is found and not used") {
  const std::uint64_t seed = GENERATE(7021U, 7022U, 7023U);
  GIVEN("a walk of which two fifths of the fixes are (0, 0, 0), seed " << seed) {
    const auto moments = moments_of("walk", seed, [&](sim::Scenario& scenario) {
      scenario.disturbances.poor_fixes = {{.share = 0.4, .default_world_m = Vector3d::Zero()}};
    });
    THEN("the status says so within two seconds") {
      CHECK(first_s(moments, status_fixes_inconsistent) < 2.0);
    }
    THEN("the pose keeps to the body") {
      CHECK(largest_error_m(moments, 3.0) < 0.2);
    }
  }
}

SCENARIO("nothing is doubted where nothing is wrong") {
  const std::string scenario = GENERATE("walk", "kart", "drone", "hand_held", "hard_stops");
  GIVEN("the scenario " + scenario) {
    const auto moments = moments_of(scenario, 7031, [](sim::Scenario&) {});
    THEN("no pose has a bit of inconsistent sensors") {
      CHECK(std::isinf(first_s(moments, status_imu_inconsistent)));
      CHECK(std::isinf(first_s(moments, status_fixes_inconsistent)));
    }
  }
}

SCENARIO("an unknown yaw is published as unknown") {
  const std::uint64_t seed = GENERATE(7041U, 7042U, 7043U);
  GIVEN("a single beacon that rests, seed " << seed) {
    const auto moments = moments_of(
        "rest", seed, [](sim::Scenario& scenario) { scenario.sensors.pair_heading = false; }, 30.0);
    THEN("the standard deviation of its yaw is that of any direction") {
      constexpr double any_rad = 1.8;  // π / √3
      for (const Moment& moment : moments) {
        if (moment.time_s > 1.0) REQUIRE(yaw_std_rad(moment.pose) > 0.8 * any_rad);
      }
    }
    THEN("its yaw does not jump") {
      constexpr double jump_rad = 5.0 * geometry::radians_per_degree;
      for (std::size_t i = 1; i < moments.size(); ++i) {
        if (moments[i - 1].time_s < 1.0) continue;
        REQUIRE(std::abs(geometry::wrap_angle(moments[i].yaw_error_rad - moments[i - 1].yaw_error_rad)) <
                jump_rad);
      }
    }
  }
}

}  // namespace kalman_wrong_imu_test
