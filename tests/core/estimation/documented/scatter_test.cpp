/// Learned noise of the fixes per axis (item 13).

#include <sonopose/estimation/documented/scatter.hpp>
#include <sonopose/estimation/documented/trust.hpp>

#include <catch2/catch.hpp>

#include <random>
#include <support/engine_driver.hpp>

namespace scatter_test {

using namespace sonopose;
using namespace sonopose::estimation::documented;
using test::EngineDriver;

constexpr double flat_m = 0.02;
constexpr double height_m = 0.4;

/// Normal noise that is larger along Z.
class FlatNoise {
public:
  Vector3d operator()() {
    return {flat_m * normal_(random_), flat_m * normal_(random_), height_m * normal_(random_)};
  }

private:
  std::mt19937 random_{7};  // NOLINT(bugprone-random-generator-seed): the same run every time
  std::normal_distribution<double> normal_;
};

/// Noise learned from fixes every 80 ms of a body at rest, with this error of the IMU's velocity.
ScatterState learned(int fixes, const Vector3d& wrong_world_mps,
                     const std::function<Vector3d(int fix)>& position_world_m) {
  ScatterState state;
  for (int i = 0; i < fixes; ++i) {
    const TimeNs now_ns = test::epoch_ns + i * TimeNs{80'000'000};
    TimedFix fix;
    fix.measured_ns = now_ns;
    fix.measured_position_world_m = position_world_m(i);
    scatter::learn(state, test::moving_body(wrong_world_mps, now_ns), fix);
  }
  return state;
}

SCENARIO("the noise of the fixes is learned per axis") {
  GIVEN("fixes with a noise of 2 cm, and of 40 cm in the height") {
    FlatNoise noise;
    const ScatterState state = learned(60, Vector3d::Zero(), [&noise](int) { return noise(); });
    THEN("it is known within a factor of two") {
      CHECK(state.noise_world_m.x() == Approx(flat_m).epsilon(0.5));
      CHECK(state.noise_world_m.y() == Approx(flat_m).epsilon(0.5));
      CHECK(state.noise_world_m.z() == Approx(height_m).epsilon(0.5));
    }
  }
  GIVEN("exact fixes and an IMU whose velocity is wrong by 3 m/s") {
    const ScatterState state = learned(60, {0.0, 0.0, 3.0}, [](int) { return Vector3d(1.0, 2.0, 3.0); });
    THEN("the fixes have no noise") {
      CHECK(state.noise_world_m == Vector3d::Constant(ScatterState::min_m));
    }
  }
  GIVEN("exact fixes that jump to a track 1 m above for a second, and back") {
    const ScatterState state = learned(
        40, Vector3d::Zero(), [](int fix) { return Vector3d(0.0, 0.0, fix > 15 && fix < 28 ? 1.0 : 0.0); });
    THEN("the fixes have no noise") {
      CHECK(state.noise_world_m.z() < 0.02);
    }
  }
}

SCENARIO("item 13: an axis counts fully up to a noise of 35 % of it, and then by less in proportion") {
  settings::TrustSettings settings;
  settings.sigma_m = 0.1;
  const Vector3d share = trust::share_of(settings, {0.02, 0.035, 0.14});
  CHECK(share.isApprox(Vector3d(1.0, 1.0, 0.25)));
  GIVEN("a fix 1 m from the pose along each axis") {
    const Kinematics body = test::moving_body(Vector3d::Zero());
    TimedFix fix;
    fix.measured_position_world_m = Vector3d::Ones();
    fix.shifted_position_world_m = Vector3d::Ones();
    WHEN("it is weighed") {
      scatter::scale_innovation(share, body, fix);
      THEN("it is taken at the share of that distance") {
        CHECK(fix.shifted_position_world_m.isApprox(Vector3d(1.0, 1.0, 0.25)));
        CHECK(fix.measured_position_world_m.isApprox(Vector3d(1.0, 1.0, 0.25)));
      }
    }
  }
}

SCENARIO("in the engine a noisy height harms neither the height nor the way") {
  GIVEN("a body that departs after a rest, with beacons that measure its height badly") {
    EngineDriver driver({}, test::departure(1.3, 0.2), test::with_headings());
    FlatNoise noise;
    driver.alter_fix = [&noise](UltrasonicFix& fix, double /*time_s*/) { fix.position_world_m += noise(); };
    const auto last = driver.run(60.0);
    THEN("the start is at rest nevertheless, and fixes are no outliers") {
      CHECK_FALSE(last.has(status_uncalibrated));
      CHECK(last.pose.trust == 1.0);
    }
    THEN("the height is better than that of a single fix by far, and the way as good as ever") {
      Vector3d squares = Vector3d::Zero();
      int count = 0;
      for (const test::Moment& moment : driver.moments) {
        if (moment.time_s < 6.0) continue;
        squares += (moment.pose.position_world_m - moment.truth.position_world_m).cwiseAbs2();
        ++count;
      }
      const Vector3d rms_m = (squares / count).cwiseSqrt();
      CAPTURE(rms_m.transpose());
      CHECK(rms_m.head<2>().maxCoeff() < 1.5 * flat_m);
      CHECK(rms_m.z() < 0.5 * height_m);
      const Vector3d std_m = position_std_m(last.pose);
      CAPTURE(std_m.transpose());
      CHECK(std_m.x() == std_m.y());
      CHECK(std_m.z() > 0.5 * rms_m.z());
      CHECK(std_m.z() < height_m);
    }
  }
}

}  // namespace scatter_test
