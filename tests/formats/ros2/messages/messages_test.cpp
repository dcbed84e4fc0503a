#include <sonopose/ros2/messages/diagnostics.hpp>
#include <sonopose/ros2/messages/input.hpp>
#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <iterator>
#include <limits>
#include <string>

namespace messages_test {

using namespace sonopose;
using namespace sonopose::ros2;

constexpr TimeNs stamp_ns = 1'700'000'000'250'000'000;

ImuSample at_rest() {
  ImuSample sample;
  sample.address = 7;
  sample.sensor_time_ns = stamp_ns;
  sample.angular_velocity_body_radps = {0.01, -0.02, 0.03};
  sample.specific_force_body_mps2 = {0, 0, 9.81};
  return sample;
}

SCENARIO("an IMU sample becomes the two messages of REP-145") {
  GIVEN("a sample at rest, and the pose at this sample") {
    const ImuSample sample = at_rest();
    FusedPose pose;
    pose.q_body_to_world = Quaterniond(0.5, 0.5, 0.5, 0.5);
    pose.angular_velocity_body_radps = {0, 0, 0};
    pose.pose_covariance.set(5, 5, 0.1 * 0.1);
    const FrameNames frames;
    WHEN("it is published raw") {
      const Imu imu = raw_imu(sample, stamp_ns, frames, {});
      THEN("it has no orientation, +g on z, and covariances") {
        CHECK(imu.orientation_covariance[0] == -1);
        CHECK(imu.linear_acceleration.z == 9.81);
        CHECK(imu.angular_velocity.y == -0.02);
        CHECK(imu.linear_acceleration_covariance[8] > 0);
        CHECK(imu.angular_velocity_covariance[0] > 0);
        CHECK(std::string(imu.header.frame_id) == "imu_link");
        CHECK(imu.header.stamp.sec == 1'700'000'000);
        CHECK(imu.header.stamp.nanosec == 250'000'000U);
      }
    }
    WHEN("it is published with the fused orientation") {
      const Imu imu = fused_imu(sample, pose, stamp_ns, frames, {});
      THEN("it has this orientation, the measured force, and the gyro without bias") {
        CHECK(imu.orientation.w == 0.5);
        CHECK(imu.orientation.z == 0.5);
        CHECK(imu.orientation_covariance[8] == Approx(0.01));
        CHECK(imu.orientation_covariance[0] > 0);
        CHECK(imu.linear_acceleration.z == 9.81);
        CHECK(imu.angular_velocity.z == 0);
      }
    }
    WHEN("it has no magnetic field") {
      THEN("there is no message") {
        CHECK_FALSE(magnetic_field(sample, stamp_ns, frames, {}));
      }
    }
    WHEN("it has a magnetic field") {
      ImuSample with = sample;
      with.magnetic_field_body_t = Vector3d(20e-6, 0, -40e-6);
      const auto field = magnetic_field(with, stamp_ns, frames, {});
      THEN("the message has it in tesla") {
        REQUIRE(field);
        CHECK(field->magnetic_field.z == -40e-6);
        CHECK(field->magnetic_field_covariance[4] > 0);
      }
    }
  }
}

SCENARIO("messages of ROS 2 drivers become samples") {
  GIVEN("a sample as sensor_msgs/Imu") {
    const ImuSample sample = at_rest();
    const FrameNames frames;
    Imu imu = raw_imu(sample, stamp_ns, frames, {});
    const TimeNs received_ns = stamp_ns + 3'000'000;
    THEN("the conversion back gives the same sample") {
      const auto back = imu_sample(imu, 7, received_ns);
      REQUIRE(back);
      CHECK(back->sample == sample);
      CHECK(back->has_angular_velocity);
      CHECK(back->has_specific_force);
    }
    WHEN("the message has no stamp") {
      imu.header.stamp = {0, 0};
      THEN("the time of measurement is the time of reception") {
        CHECK(imu_sample(imu, 7, received_ns)->sample.sensor_time_ns == received_ns);
      }
    }
    WHEN("REP-145 marks one sensor as absent") {
      imu.angular_velocity_covariance[0] = -1;
      imu.angular_velocity.x = std::numeric_limits<double>::quiet_NaN();
      THEN("the other one is used") {
        const auto part = imu_sample(imu, 7, received_ns);
        REQUIRE(part);
        CHECK_FALSE(part->has_angular_velocity);
        CHECK(part->has_specific_force);
        CHECK(part->sample.angular_velocity_body_radps == Vector3d::Zero());
        CHECK(part->sample.specific_force_body_mps2 == sample.specific_force_body_mps2);
      }
    }
    WHEN("a value is not finite, or the stamp is invalid") {
      Imu broken = imu;
      broken.linear_acceleration.x = std::numeric_limits<double>::quiet_NaN();
      Imu late = imu;
      late.header.stamp.nanosec = 2'000'000'000U;
      THEN("there is no sample") {
        CHECK_FALSE(imu_sample(broken, 7, received_ns));
        CHECK_FALSE(imu_sample(late, 7, received_ns));
      }
    }
  }
  GIVEN("a position from a positioning system, as a point and as a pose") {
    const FrameNames frames;
    const Vector3d where(1.5, -2.5, 0.75);
    const PointStamped point = position_as_point(where, stamp_ns, frames);
    PoseWithCovarianceStamped pose = position_as_pose(where, fix_covariance(0.02, 1.0), stamp_ns, frames);
    const TimeNs received_ns = stamp_ns + 40'000'000;
    THEN("both are the same fix, with the times of emission and reception") {
      for (const auto& taken : {fix(point, 9, received_ns), fix(pose, 9, received_ns)}) {
        REQUIRE(taken);
        CHECK(taken->address == 9);
        CHECK(taken->position_world_m == where);
        CHECK(taken->emission_time_ns == stamp_ns);
        CHECK(taken->received_time_ns == received_ns);
        CHECK(taken->measured_delay_s.value_or(-1) == Approx(0.04));
      }
    }
    WHEN("its clock is ahead, so that it arrives before its stamp") {
      const auto taken = fix(pose, 9, stamp_ns - 2'000'000);
      THEN("it was measured at its stamp, without a delay") {
        CHECK(taken->emission_time_ns == stamp_ns);
        CHECK(taken->received_time_ns == stamp_ns);
        CHECK(taken->measured_delay_s.value_or(-1) == 0.0);
      }
    }
    WHEN("it has no stamp") {
      pose.header.stamp = {0, 0};
      THEN("it was measured when it arrived, and no fixed delay applies") {
        const auto taken = fix(pose, 9, received_ns);
        REQUIRE(taken);
        CHECK(taken->emission_time_ns == received_ns);
        CHECK(taken->measured_delay_s.value_or(-1) == 0.0);
      }
    }
    WHEN("the pose states the covariance of its position") {
      const auto std_m = [&](int axis) {
        return fix(pose, 9, received_ns)->covariance_world_m2->std_dev(axis);
      };
      auto& covariance = pose.pose.covariance;
      THEN("the fix has it, with the correlations") {
        covariance[0] = 0.04;
        covariance[1] = covariance[6] = 0.01;
        covariance[7] = 0.09;
        CHECK(std_m(0) == Approx(0.2));
        CHECK_FALSE(covariance_fault(pose));
        CHECK(fix(pose, 9, received_ns)->covariance_world_m2->at(0, 1) == 0.01);
      }
      THEN("a variance that no system reaches is raised, for this axis alone") {
        covariance[14] = 0;
        CHECK(std_m(1) == Approx(0.02));
        CHECK(std_m(2) == Approx(min_fix_std_m));
      }
      THEN("zeros and values that are not finite mean that it is unknown") {
        covariance[1] = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(fix(pose, 9, received_ns)->covariance_world_m2);
        CHECK(covariance_fault(pose)->reason == std::string("not finite"));
        std::fill(std::begin(covariance), std::end(covariance), 0.0);
        CHECK_FALSE(fix(pose, 9, received_ns)->covariance_world_m2);
        CHECK_FALSE(covariance_fault(pose));
      }
    }
    WHEN("the covariance cannot be one") {
      auto& covariance = pose.pose.covariance;
      const auto is_unknown = [&](int row, int column, double value, const std::string& reason) {
        const auto fault = covariance_fault(pose);
        REQUIRE(fault);
        CHECK(fault->row == row);
        CHECK(fault->column == column);
        CHECK(fault->value_m2 == value);
        CHECK_THAT(fault->reason, Catch::Contains(reason));
        CHECK_FALSE(fix(pose, 9, received_ns)->covariance_world_m2);
      };
      THEN("it is unknown, and its first fault is found") {
        SECTION("variances that are too large") {
          for (const double value : {1e308, 1e6}) {
            covariance[0] = covariance[7] = covariance[14] = value;
            is_unknown(0, 0, value, "above");
          }
        }
        SECTION("a negative variance") {
          covariance[7] = -1;
          is_unknown(1, 1, -1, "negative");
          covariance[0] = covariance[14] = 0;
          is_unknown(1, 1, -1, "negative");
        }
        SECTION("not symmetric") {
          covariance[1] = 1e-4;
          is_unknown(0, 1, 1e-4, "not symmetric");
        }
        SECTION("correlations beyond one") {
          covariance[1] = covariance[6] = 0.01;
          is_unknown(0, 1, 0.01, "not positive definite");
        }
      }
    }
    WHEN("a driver in the plane does not know the height") {
      pose.pose.covariance[14] = 1e6;
      THEN("only this axis is unknown") {
        const auto taken = fix(pose, 9, received_ns);
        REQUIRE(taken->covariance_world_m2);
        CHECK(taken->covariance_world_m2->std_dev(0) == Approx(0.02));
        CHECK(taken->covariance_world_m2->std_dev(2) == Approx(max_fix_std_m));
        CHECK_FALSE(covariance_fault(pose));
      }
    }
    WHEN("it is infinite") {
      pose.pose.pose.position.y = std::numeric_limits<double>::infinity();
      THEN("there is no fix") {
        CHECK_FALSE(fix(pose, 9, received_ns));
      }
    }
  }
}

TEST_CASE("The diagnostics message has order, texts and levels") {
  const std::vector<Diagnostic> diagnostics{{Level::ok,
                                             "sonopose: beacon 7",
                                             "poses at 100.0 Hz",
                                             "7",
                                             {{"trust", "1.000"}, {"battery_v", "3.91"}}},
                                            {Level::stale, "sonopose: beacon 9", "no pose", "9", {}}};
  const DiagnosticMessage made(diagnostics, stamp_ns);
  const DiagnosticArray& message = made.message();
  REQUIRE(message.status._length == 2);
  CHECK(message.header.stamp.sec == 1'700'000'000);
  CHECK(message.status._buffer[0].level == 0);
  CHECK(message.status._buffer[1].level == 3);
  CHECK(std::string(message.status._buffer[0].hardware_id) == "7");
  REQUIRE(message.status._buffer[0].values._length == 2);
  CHECK(std::string(message.status._buffer[0].values._buffer[1].key) == "battery_v");
  CHECK(std::string(message.status._buffer[0].values._buffer[1].value) == "3.91");
  CHECK(message.status._buffer[1].values._length == 0);
}

}  // namespace messages_test
