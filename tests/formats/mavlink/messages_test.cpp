#include "mavlink/messages.hpp"

#include "formats/mavlink/flying.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>

namespace mavlink_messages_test {

using namespace sonopose;
using mavlink::Frame;

constexpr mavlink::Identity own{5, mavlink::own_component};

template <class T>
T at(const Frame& frame, std::size_t offset) {
  T value{};
  std::memcpy(&value, frame.payload.data() + offset, sizeof value);
  return value;
}

Frame timesync(std::int64_t tc1, std::int64_t ts1) {
  Frame frame{.message_id = 111, .sender = {5, 1}};
  std::memcpy(frame.payload.data(), &tc1, sizeof tc1);
  std::memcpy(frame.payload.data() + 8, &ts1, sizeof ts1);
  frame.size = 18;
  return frame;
}

SCENARIO("an autopilot's time synchronisation is answered") {
  GIVEN("its request") {
    const auto answer = timesync_answer(timesync(0, 123'456), own, flying::stamp_ns);
    THEN("the answer has our time, and mirrors its own") {
      REQUIRE(answer);
      CHECK(at<std::int64_t>(*answer, 0) == flying::stamp_ns);
      CHECK(at<std::int64_t>(*answer, 8) == 123'456);
      CHECK(int{answer->payload[16]} == 5);
      CHECK(int{answer->payload[17]} == 1);
    }
  }
  GIVEN("an answer to somebody else") {
    THEN("it is not answered") {
      CHECK_FALSE(timesync_answer(timesync(99, 1), own, flying::stamp_ns));
    }
  }
}

SCENARIO("ODOMETRY has the pose in the frames that the autopilot takes") {
  const mavlink::PoseMessageFields fields{
      .time_ns = flying::stamp_ns, .in_ned = false, .reset_counter = 3, .quality_percent = 80};
  GIVEN("a pose with yaw") {
    const Frame frame = mavlink::odometry(flying::odometry(), own, fields);
    THEN("its fields are where the definition has them") {
      CHECK(frame.size == 233);
      CHECK(at<std::uint64_t>(frame, 0) == flying::stamp_ns / 1000);
      CHECK(at<float>(frame, 16) == -3);                  // z
      CHECK(at<float>(frame, 36) == 4);                   // vx
      CHECK(at<float>(frame, 60 + 4 * 6) == 12);          // the variance of y
      CHECK(at<float>(frame, 60 + 4 * 20) == 56);         // the variance of yaw
      CHECK(at<float>(frame, 144) == 0.1F);               // the variance of vx
      CHECK(std::isnan(at<float>(frame, 144 + 4 * 15)));  // of the rates: not known
      CHECK(int{frame.payload[228]} == 20);               // MAV_FRAME_LOCAL_FRD
      CHECK(int{frame.payload[229]} == 12);               // MAV_FRAME_BODY_FRD
      CHECK(int{frame.payload[230]} == 3);
      CHECK(int{frame.payload[231]} == 2);  // MAV_ESTIMATOR_TYPE_VISION, which PX4 takes
      CHECK(int{frame.payload[232]} == 80);
    }
  }
  GIVEN("one without yaw") {
    auto odometry = flying::odometry();
    odometry.q_body_to_frame.reset();
    THEN("its quaternion, and the yaw of the other message, are NaN") {
      CHECK(std::isnan(at<float>(mavlink::odometry(odometry, own, fields), 20)));
      CHECK(std::isnan(at<float>(mavlink::vision_position_estimate(odometry, own, fields), 28)));
    }
  }
}

}  // namespace mavlink_messages_test
