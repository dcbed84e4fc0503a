/// ROS 2 drivers feed the fusion through the relay.

#include "clocks/clocks.hpp"
#include "support/ros2.hpp"
#include "support/wait_until.hpp"
#include "system/doctor_run.hpp"

#include <chrono>
#include <cmath>
#include <csignal>
#include <deque>
#include <memory>
#include <random>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

namespace sonopose::ros2_input_test {

using namespace sonopose::test;
namespace topics = dds::topics;
using Catch::Contains;

/// Five standard deviations of a fix, which may be the only one so far.
constexpr double max_off_m = 0.1;

/// A robot on a level circle around (1, 2, 0.5) that faces along its path; at rest at the centre if the
/// radius is 0.
struct Motion {
  double radius_m = 0;
  double rate_radps = 0;

  [[nodiscard]] Vector3d position_m(TimeNs time_ns) const {
    const double angle = rate_radps * seconds_between(start_ns, time_ns);
    return Vector3d(1, 2, 0.5) + radius_m * Vector3d(std::cos(angle), std::sin(angle), 0);
  }
  [[nodiscard]] ImuSample imu() const {
    ImuSample sample;
    sample.angular_velocity_body_radps = {0, 0, rate_radps};
    sample.specific_force_body_mps2 = {0, radius_m * rate_radps * rate_radps, standard_gravity_mps2};
    return sample;
  }

  TimeNs start_ns = clocks::host_now();
};

/// Motion and timing of a robot's drivers.
struct Driving {
  Motion motion{};
  TimeNs fix_delay_ns = 0;  ///< delay from a fix's stamp to its message
  TimeNs fix_age_ns = 0;    ///< age of the fixes' stamps relative to those of the IMU
  TimeNs age_ns = 0;        ///< age of all stamps, as in a recording that is played back
};

/// Drivers of an IMU at 100 Hz and of fixes with 2 cm noise at 10 Hz. Stamps do not depend on the machine's
/// load.
class Drivers {
public:
  static constexpr TimeNs period_ns = 10'000'000;

  explicit Drivers(const Bus& bus, Driving driving = {})
      : driving_(driving), imu_(bus, "/imu/data", false), position_(bus, "/tag/pose") {}

  bool wait_for_readers() { return imu_.wait_for_reader() && position_.wait_for_reader(); }

  /// Sends the next IMU sample and the fixes that arrive with it. Returns the time of the sample.
  TimeNs send() {
    const TimeNs now_ns = driving_.motion.start_ns + count_ * period_ns;
    imu_.write(ros2::raw_imu(driving_.motion.imu(), now_ns - driving_.age_ns, frames_, {}));
    if (count_++ % 10 == 0) {
      measured_.emplace_back(now_ns, driving_.motion.position_m(now_ns) + noise_m());
    }
    while (!measured_.empty() && now_ns - measured_.front().first >= driving_.fix_delay_ns) {
      const auto& [stamp_ns, position_m] = measured_.front();
      position_.write(ros2::position_as_pose(position_m, ros2::fix_covariance(noise_std_m, 1.0),
                                             stamp_ns - driving_.fix_age_ns - driving_.age_ns, frames_));
      measured_.pop_front();
    }
    return now_ns;
  }

private:
  Vector3d noise_m() { return {normal_(random_), normal_(random_), normal_(random_)}; }

  static constexpr double noise_std_m = 0.02;
  Driving driving_;
  ros2::FrameNames frames_;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_{0.0, noise_std_m};
  RosWriter<ros2::Imu> imu_;
  RosWriter<ros2::PoseWithCovarianceStamped> position_;
  std::deque<std::pair<TimeNs, Vector3d>> measured_;
  int count_ = 0;
};

/// Drivers that send in real time during their lifetime.
class LiveDrivers {
public:
  explicit LiveDrivers(const Bus& bus, Driving driving = {}) : drivers_(bus, driving) {}

private:
  void drive(const std::stop_token& end) {
    auto next = std::chrono::steady_clock::now();
    while (!end.stop_requested()) {
      drivers_.send();
      std::this_thread::sleep_until(next += std::chrono::nanoseconds(Drivers::period_ns));
    }
  }

  Drivers drivers_;
  std::jthread thread_{[this](const std::stop_token& end) { drive(end); }};
};

SCENARIO("a late fix is placed at its stamp") {
  GIVEN("a fusion, and the recording of a robot at 1 m/s whose fixes arrive 300 ms after their stamps") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--imu-in", "/imu/data=42", "--fix-in", "/tag/pose=42"});
    const Driving driving{.motion = {.radius_m = 2, .rate_radps = 0.5},
                          .fix_delay_ns = 300'000'000,
                          .age_ns = 86'400'000'000'000};
    Drivers drivers(bus, driving);
    REQUIRE(drivers.wait_for_readers());
    WHEN("it is played for 15 s as fast as the fusion follows") {
      for (int i = 0; i < 1500; ++i) {
        const TimeNs min_ns = drivers.send() - driving.age_ns - 20 * Drivers::period_ns;
        if (i < 100) {
          std::this_thread::sleep_for(std::chrono::nanoseconds(Drivers::period_ns));
        } else {
          REQUIRE(poses.wait_until(
              [&] { return !poses.samples.empty() && poses.samples.back().time_ns >= min_ns; }));
        }
      }
      THEN("the pose is where the robot is, not 30 cm behind it") {
        double squared_m2 = 0;
        double count = 0;  // an overloaded fusion skips poses
        for (const FusedPose& pose : poses.samples) {
          if (seconds_between(pose.time_ns, poses.samples.back().time_ns) > 5) continue;
          ++count;
          squared_m2 += (pose.position_world_m - driving.motion.position_m(pose.time_ns + driving.age_ns))
                            .squaredNorm();
        }
        CHECK(std::sqrt(squared_m2 / count) < 0.06);
      }
    }
  }
}

SCENARIO("a recording that is played back is fused like live sensors") {
  GIVEN("a fusion, and the drivers of a robot at rest with stamps of yesterday") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--imu-in", "/imu/data=42", "--fix-in", "/tag/pose=42"});
    const LiveDrivers drivers(bus, {.age_ns = 86'400'000'000'000});
    THEN("the pose follows them, in the time of the recording") {
      REQUIRE(poses.wait_for([](const FusedPose& pose) {
        return (pose.status & (status_initialising | status_converging)) == 0;
      }));
      const FusedPose& pose = poses.samples.back();
      CHECK((pose.position_world_m - Vector3d(1, 2, 0.5)).norm() < max_off_m);
      CHECK(seconds_between(pose.time_ns, clocks::host_now()) == Approx(86'400).margin(60));
    }
  }
}

/// Repeats the write until `done()`, because an unmatched reader misses the first messages of a volatile
/// writer.
template <class Write, class Done>
bool repeat_until(const Write& write, const Done& done) {
  return wait_until([&] {
    write();
    return done();
  });
}

SCENARIO("with simulated time, messages have the time of /clock") {
  GIVEN("a relay that uses simulated time, and a simulator whose time has just begun") {
    const Bus bus;
    Consumer<sonopose_UltrasonicFix> fixes(bus, topics::fix);
    RosReader<ros2::DiagnosticArray> diagnostics(bus, "/diagnostics");
    Arguments arguments{"--fix-in", "/tag:PointStamped=42"};
    const Arguments use =
        GENERATE(Arguments{"--use-sim-time"}, Arguments{"--ros-args", "-p", "use_sim_time:=true", "--"});
    arguments.insert(arguments.end(), use.begin(), use.end());
    const auto relay = bus.ros2(arguments);
    RosWriter<ros2::Clock> clock(bus, "/clock");
    RosWriter<ros2::PointStamped> position(bus, "/tag");
    constexpr TimeNs now_ns = 12'345'000'000;
    const auto is_now = [](TimeNs time_ns) { return time_ns >= now_ns && time_ns < now_ns + 1'000'000; };
    REQUIRE(repeat_until([&] { clock.write({ros2::to_ros(now_ns)}); },
                         [&] {
                           return diagnostics.wait_for(
                               [&](const auto& message) { return is_now(stamp_of(message.header)); },
                               std::chrono::milliseconds(100));
                         }));
    WHEN("a position without a stamp arrives") {
      THEN("it was measured at this time") {
        REQUIRE(repeat_until(
            [&] {
              position.write(ros2::position_as_point({1, 2, 3}, 0, {}));
            },
            [&] { return fixes.wait_for_count(1, std::chrono::milliseconds(100)); }));
        CHECK(is_now(fixes.samples.front().emission_time_ns));
      }
    }
  }
}

SCENARIO("simulated time that nobody publishes is named") {
  GIVEN("a relay that uses simulated time, without a simulator") {
    const Bus bus;
    const auto relay = bus.ros2({"--use-sim-time"});
    THEN("it says so, with the remedy") {
      CHECK(
          relay->wait_for_line(Stream::error, "no message on /clock yet, though --use-sim-time follows it"));
    }
    WHEN("a simulator is paused at its start") {
      RosWriter<ros2::Clock> clock(bus, "/clock");
      THEN("the relay says that the time stays at 0") {
        CHECK(repeat_until([&] { clock.write({ros2::to_ros(0)}); },
                           [&] {
                             return relay->wait_for_line(Stream::error, "no time after 0 on /clock yet",
                                                         std::chrono::milliseconds(100));
                           }));
      }
    }
  }
}

SCENARIO("fixes of another clock than the IMU's are refused with the reason") {
  GIVEN("a fusion, and drivers whose fixes are stamped an hour before their IMU samples") {
    const Bus bus;
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--imu-in", "/imu/data=42", "--fix-in", "/tag/pose=42"});
    const LiveDrivers drivers(bus, {.fix_age_ns = 3'600'000'000'000});
    THEN("the fusion reports it, and the doctor too") {
      REQUIRE(fusion->wait_for_line(Stream::error, "beacon 42: all fixes are refused"));
      const Result doctor = look_for("its fusion refuses ", bus.domain_id(), {"--duration", "2.5"});
      CHECK_THAT(doctor.output,
                 Contains("its fusion refuses ") && Contains(" too old (admission.max_fix_age_s)"));
    }
  }
}

SCENARIO("any IMU and any positioning system with a ROS 2 driver feed the fusion") {
  GIVEN("a fusion, a relay that forwards both as beacon 42, and drivers") {
    const Bus bus;
    Consumer<sonopose_FusedPose> poses(bus, topics::pose);
    Consumer<sonopose_BeaconStatus> status(bus, topics::beacon_status, dds::topics::Delivery::live);
    RosReader<ros2::Odometry> odometry(bus, "/hedge_42/odom");
    const auto fusion = bus.fusion();
    const auto relay = bus.ros2({"--imu-in", "/imu/data=42", "--fix-in", "/tag/pose=42"});
    auto drivers = std::make_unique<LiveDrivers>(bus);
    THEN("the pose follows the drivers, natively and in ROS 2, and the bridge status reports them") {
      REQUIRE(poses.wait_for([](const FusedPose& pose) {
        return (pose.status & (status_initialising | status_converging)) == 0;
      }));
      const FusedPose& pose = poses.samples.back();
      CHECK(pose.address == 42);
      CHECK((pose.position_world_m - Vector3d(1, 2, 0.5)).norm() < max_off_m);
      REQUIRE(odometry.wait_for_count(1, [&](const auto& message) {
        CHECK((ros2::base_in_map(message).translation_m - Vector3d(1, 2, 0.5)).norm() < max_off_m);
      }));
      REQUIRE(status.wait_for(
          [](const BeaconStatus& one) { return one.imu_rate_hz > 0 && one.fix_rate_hz > 0; }));
      CHECK(status.samples.back().samples_rejected == 0);
    }
    WHEN("the drivers stop, and start again") {
      REQUIRE(poses.wait_for_count(20));
      drivers.reset();
      THEN("the relay reports which stream is silent, and when it resumes, and ends on a signal") {
        REQUIRE(relay->wait_for_line(Stream::error, "beacon 42: no IMU samples from ROS 2"));
        REQUIRE(relay->wait_for_line(Stream::error, "beacon 42: no fixes from ROS 2"));
        const LiveDrivers again(bus);
        CHECK(relay->wait_for_line(Stream::error, "beacon 42: IMU samples from ROS 2 again"));
        CHECK(relay->end_by(SIGTERM).code == 0);
      }
    }
  }
  GIVEN("a relay whose input is its own output") {
    const Result result = run(SONOPOSE_TEST_ROS2, {"--imu-in", "/hedge_7/imu/data_raw=7", "--domain", "0"});
    THEN("it reports the loop") {
      CHECK(result.code == 105);  // a wrong option
      CHECK(result.error.find("relay's own output") != std::string::npos);
    }
  }
}

}  // namespace sonopose::ros2_input_test
