/// Messages of drivers that have only a part of the data, or that state an unusable covariance.

#include "clocks/clocks.hpp"
#include "ros2/relay/source_rig.hpp"
#include <sonopose/ros2/messages/input.hpp>

#include <atomic>
#include <limits>
#include <optional>

namespace sonopose::driver_messages_test {

using namespace source_rig;

/// A message of one sensor of an IMU, as REP-145 marks it.
ros2::Imu sensor_at(TimeNs stamp_ns, const Vector3d& rate_radps, const Vector3d& force_mps2,
                    bool is_gyroscope) {
  ros2::Imu imu = imu_at(stamp_ns);
  if (is_gyroscope) {
    imu.angular_velocity = {rate_radps.x(), rate_radps.y(), rate_radps.z()};
    imu.linear_acceleration_covariance[0] = -1;
  } else {
    imu.linear_acceleration = {force_mps2.x(), force_mps2.y(), force_mps2.z()};
    imu.angular_velocity_covariance[0] = -1;
  }
  return imu;
}

SCENARIO("an IMU may come as two sensors, and a part without data is not used") {
  const Vector3d rate(0.1, 0.2, 0.3);
  const Vector3d force(0, 0, 9.81);
  const TimeNs begin_ns = clocks::host_now();
  GIVEN("the accelerometer and the gyroscope on two topics") {
    Rig rig({{Kind::imu, "/accel", 7}, {Kind::imu, "/gyro", 7}});
    auto accel = rig.driver<ros2::Imu>("/accel");
    auto gyro = rig.driver<ros2::Imu>("/gyro");
    rig.run();
    WHEN("both send") {
      for (int i = 0; i < 5; ++i) {
        accel.write(sensor_at(begin_ns + i * second_ns / 100, rate, force, false));
        gyro.write(sensor_at(begin_ns + i * second_ns / 100, rate, force, true));
      }
      THEN("their samples are complete, and the log says so") {
        REQUIRE(wait_until([&] { return !rig.sink.imu_samples().empty(); }));
        CHECK(rig.sink.imu_samples().front().angular_velocity_body_radps == rate);
        CHECK(rig.sink.imu_samples().front().specific_force_body_mps2.isApprox(force));
        CHECK(rig.logs("beacon 7: /gyro has the angular velocity of samples"));
      }
    }
  }
  GIVEN("an IMU without a gyroscope") {
    Rig rig({{Kind::imu, "/imu", 7}});
    auto imu = rig.driver<ros2::Imu>("/imu");
    rig.run();
    imu.write(sensor_at(begin_ns, rate, force, false));
    THEN("its samples are not used, for a reason") {
      CHECK(rig.logs("beacon 7: /imu has messages without an angular velocity"));
      CHECK(rig.logs("no IMU samples from ROS 2 yet: the messages on /imu have only one of"));
      CHECK(rig.sink.count() == 0);
    }
  }
  GIVEN("two topics with complete samples") {
    Rig rig({{Kind::imu, "/a", 7}, {Kind::imu, "/b", 7}});
    auto first = rig.driver<ros2::Imu>("/a");
    auto second = rig.driver<ros2::Imu>("/b");
    rig.run();
    ros2::Imu complete = sensor_at(begin_ns, rate, force, false);
    complete.angular_velocity_covariance[0] = 0;
    complete.angular_velocity.x = 1;
    first.write(complete);
    REQUIRE(wait_until([&] { return rig.sink.count() == 1; }));
    second.write(complete);
    THEN("the second one is not mixed with the first") {
      CHECK(rig.logs("beacon 7: /b is not used: the samples of /a are complete"));
      CHECK(rig.sink.count() == 1);
    }
  }
}

SCENARIO("an unusable covariance is named with its value") {
  GIVEN("a driver of fixes") {
    Rig rig({{Kind::fix, "/tag", 7}});
    auto fixes = rig.driver<ros2::PoseWithCovarianceStamped>("/tag");
    rig.run();
    const ros2::FrameNames frames;
    auto pose = ros2::position_as_pose({1, 2, 3}, ros2::Covariance3::Identity(), clocks::host_now(), frames);
    WHEN("it states a variance of 1e308") {
      pose.pose.covariance[0] = 1e308;
      fixes.write(pose);
      THEN("its fix is used as if this axis were unknown") {
        REQUIRE(wait_until([&] { return rig.sink.count() == 1; }));
        const auto covariance = rig.sink.fixes().front().covariance_world_m2;
        REQUIRE(covariance);
        CHECK(covariance->std_dev(0) == Approx(ros2::max_fix_std_m));
        CHECK(covariance->std_dev(1) == Approx(1));
      }
    }
    WHEN("it states a negative variance") {
      pose.pose.covariance[0] = -1;
      fixes.write(pose);
      THEN("its fix is used without a covariance") {
        REQUIRE(wait_until([&] { return rig.sink.count() == 1; }));
        CHECK_FALSE(rig.sink.fixes().front().covariance_world_m2);
        CHECK(rig.logs("beacon 7: /tag has an unusable covariance, which counts as unknown: -1 m² (x, x)"));
      }
    }
  }
}

SCENARIO("two tags on one robot have their places") {
  GIVEN("a tag in the IMU, and one 0.4 m left of the base, 0.1 m above the IMU") {
    Rig rig({Input::parse(Kind::fix, "/a:PointStamped=7"),
             Input::parse(Kind::fix, "/b:PointStamped=7@0,0.4,0.3")});
    rig.source->use(ros2::InputFrames{.mount =
                                          [](BeaconAddress) {
                                            return ros2::Mount{.imu_in_base_m = {0, 0, 0.2}};
                                          },
                                      .in_map = {},
                                      .in_base = {}});
    auto first = rig.driver<ros2::PointStamped>("/a");
    auto second = rig.driver<ros2::PointStamped>("/b");
    rig.run();
    const TimeNs begin_ns = clocks::host_now();
    WHEN("both send the same position") {
      first.write(fix_at(begin_ns, {}));
      REQUIRE(wait_until([&] { return rig.sink.count() == 1; }));
      second.write(fix_at(begin_ns + second_ns / 10, {}));
      THEN("each is used, with the place of its tag") {
        REQUIRE(wait_until([&] { return rig.sink.count() == 2; }));
        CHECK(rig.sink.fixes().front().point_body_m.isZero(0));
        CHECK(rig.sink.fixes().back().point_body_m.isApprox(Vector3d(0, 0.4, 0.1)));
      }
    }
  }
}

SCENARIO("a tag with a place waits for the mount of the IMU") {
  GIVEN("a tag on the base, and a mount that tf does not have yet") {
    std::atomic<bool> is_known = false;
    Rig rig({Input::parse(Kind::fix, "/b:PointStamped=7@0,0.4,0.3")});
    rig.source->use(ros2::InputFrames{.mount = [&](BeaconAddress) -> std::optional<ros2::Mount> {
                                        if (!is_known) return std::nullopt;
                                        return ros2::Mount{.imu_in_base_m = {0, 0, 0.2}};
                                      },
                                      .in_map = {},
                                      .in_base = {}});
    auto tag = rig.driver<ros2::PointStamped>("/b");
    rig.run();
    const TimeNs begin_ns = clocks::host_now();
    WHEN("it sends a position before and after") {
      tag.write(fix_at(begin_ns, {}));
      REQUIRE(wait_until([&] { return rig.logs("does not have the mount of the IMU on the base yet"); }));
      is_known = true;
      tag.write(fix_at(begin_ns + second_ns / 10, {}));
      THEN("only the second is used, with its place seen from the IMU") {
        REQUIRE(wait_until([&] { return rig.sink.count() == 1; }));
        CHECK(rig.sink.fixes().front().point_body_m.isApprox(Vector3d(0, 0.4, 0.1)));
      }
    }
  }
}

SCENARIO("fixes of another clock than the IMU are named with the difference") {
  GIVEN("a driver of fixes whose clock is 0.7 s ahead of that of the IMU") {
    Rig rig({{Kind::imu, "/imu", 7}, {Kind::fix, "/tag", 7}});
    auto imu = rig.driver<ros2::Imu>("/imu");
    auto fixes = rig.driver<ros2::PointStamped>("/tag");
    rig.run();
    THEN("the log says so after some seconds") {
      CHECK(wait_until([&] {
        const TimeNs now_ns = clocks::host_now();
        imu.write(imu_at(now_ns));
        fixes.write(fix_at(now_ns + 7 * second_ns / 10, {}));
        rig.source->log_changes();
        return rig.has_logged("s newer than those of /imu, each against its arrival, so their clocks differ");
      }));
    }
  }
}

SCENARIO("PX4's sensor_combined is the IMU of a beacon") {
  // FRD: at rest and level, the accelerometer reads -9.81 down; a turn to the right is positive.
  ros2::SensorCombined message{};
  const TimeNs end_ns = clocks::host_now() / 1000 * 1000;
  message.timestamp = static_cast<std::uint64_t>(end_ns / 1000);
  message.gyro_integral_dt = 5000;
  message.gyro_rad[0] = 0.1F;
  message.gyro_rad[2] = 0.3F;
  message.accelerometer_m_s2[2] = -9.81F;
  GIVEN("a beacon with this input") {
    Rig rig({Input::parse(Kind::imu, "/fmu/out/sensor_combined:SensorCombined=7")});
    // As PX4's client writes.
    const dds::Qos qos = dds::Qos() << dds::policy::Reliability::BestEffort();
    auto px4 = rig.driver<ros2::SensorCombined>("/fmu/out/sensor_combined", qos);
    rig.run();
    WHEN("PX4 is level and turns right") {
      REQUIRE(wait_until([&] {
        px4.write(message);
        return rig.sink.count() > 0;
      }));
      const ImuSample sample = rig.sink.imu_samples().front();
      THEN("the sample is that of a level body with z up, in the middle of its interval") {
        CHECK(sample.address == 7);
        CHECK(sample.specific_force_body_mps2.isApprox(Vector3d(0, 0, 9.81), 1e-6));
        CHECK(sample.angular_velocity_body_radps.isApprox(Vector3d(0.1, 0, -0.3), 1e-6));
        CHECK(sample.sensor_time_ns == end_ns - 2'500'000);
        CHECK(sample.meaning == ImuMeaning::instant);
      }
    }
    WHEN("the accelerometer has no data") {
      message.accelerometer_timestamp_relative = 0x7fffffff;
      px4.write(message);
      THEN("there is no sample, for a reason") {
        CHECK(rig.logs("the messages on /fmu/out/sensor_combined have only one of"));
        CHECK(rig.sink.count() == 0);
      }
    }
    WHEN("a value is not finite, or the stamp is beyond all times") {
      message.gyro_rad[1] = std::numeric_limits<float>::infinity();
      CHECK_FALSE(ros2::imu_sample(message, 7));
      message.gyro_rad[1] = 0;
      message.timestamp = std::numeric_limits<std::uint64_t>::max();
      THEN("it is not used") {
        CHECK_FALSE(ros2::imu_sample(message, 7));
      }
    }
  }
}

}  // namespace sonopose::driver_messages_test
