/// Recordings of rosbag2 as inputs of the fusion.

#include "ros2/bag/bag_log.hpp"

#include "bus_log/recorded.hpp"
#include "bus_log/sensor_log.hpp"
#include "mcap/compression.hpp"
#include "ros2/bag/drives.hpp"
#include "support/events.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <map>
#include <numbers>

namespace bag_log_test {

using namespace sonopose;
using Catch::Contains;
using ros2::AidingInput;
using ros2::bag::TopicChoice;
using sonopose::test::RosMessage;
using sonopose::test::TemporaryFolder;

ros2::bag::BagLog read(const std::filesystem::path& file, const TopicChoice& choice = {},
                       std::optional<BeaconAddress> address = {}) {
  const mcap::Reader reader(file);
  return ros2::bag::read_bag(*ros2::bag::mcap_storage(reader), choice, address);
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

/// Numbers of events by their index in Event.
std::map<std::size_t, int> kinds_of(const std::vector<Event>& events) {
  std::map<std::size_t, int> counts;
  for (const Event& event : events) ++counts[event.index()];
  return counts;
}

template <class Sample>
Sample first(const std::vector<Event>& events) {
  const auto found =
      std::ranges::find_if(events, [](const Event& event) { return std::holds_alternative<Sample>(event); });
  REQUIRE(found != events.end());
  return std::get<Sample>(*found);
}

SCENARIO("a recording of rosbag2 is an input like a log folder") {
  const TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  GIVEN("a drive of an IMU and a tag, as each distribution records it, in either byte order") {
    const auto layout = GENERATE(test::BagLayout{}, test::BagLayout{.has_type_hashes = true},
                                 test::BagLayout{.message_encoding = "", .has_definitions = false},
                                 test::BagLayout{.schema_encoding = "ros2idl", .has_definitions = false});
    const auto byte_order = GENERATE(std::endian::little, std::endian::big);
    const auto events = test::walk_events(10.0);
    test::write_bag(file, test::messages_of(events, byte_order), layout);
    THEN("its topics are found by their types, and its events are those of the drivers, to the bit") {
      const auto bag = read(file);
      CHECK(test::difference(bag.log.events, events) == "");
      CHECK(bag.log.address == 7);
      CHECK(joined(bag.log.warnings).empty());
      REQUIRE(bag.notes.size() == 2);
      CHECK_THAT(bag.notes[0], Contains("uses /imu/data (sensor_msgs/msg/Imu, 1000 messages) as the IMU"));
      CHECK_THAT(bag.notes[1], Contains("uses /tag/point (geometry_msgs/msg/PointStamped"));
    }
    THEN("every program reads it by the one function for all recordings") {
      CHECK(test::difference(bus_log::read_sensor_log(file).events, events) == "");
      CHECK(bus_log::read_sensor_log(folder.path(), BeaconAddress{9}).address == 9);
      CHECK(bus_log::read_imu_log(file).size() == 1000);
    }
  }
}

SCENARIO("topics are chosen as for the relay") {
  const TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  const auto events = test::walk_events(2.0);
  auto messages = test::messages_of(events);
  GIVEN("two IMUs, two topics of positions, and an image topic's odometry") {
    const auto& imu = std::get<ImuSample>(events.front());
    const auto& fix = std::get<UltrasonicFix>(*std::ranges::find_if(
        events, [](const Event& event) { return std::holds_alternative<UltrasonicFix>(event); }));
    messages.push_back(test::imu_message(imu, "/camera/imu"));
    messages.push_back(test::fix_message(fix, "/other"));
    test::write_bag(file, messages);
    THEN("without a choice the candidates are listed") {
      CHECK_THROWS_WITH(read(file), Contains("drive_0.mcap: has several topics of sensor_msgs/msg/Imu; "
                                             "choose with --imu-in, or for the bridge ") &&
                                        Contains("/imu/data (sensor_msgs/msg/Imu, 200 messages)") &&
                                        Contains("/camera/imu (sensor_msgs/msg/Imu, 1 message)"));
      CHECK_THROWS_WITH(read(file, {.imu = {"/imu/data"}}),
                        Contains("choose with --fix-in") && Contains("/other"));
    }
    THEN("the chosen ones are read, with and without slash, type and address, and the others are counted") {
      for (const TopicChoice& choice :
           {TopicChoice{.imu = {"/imu/data"}, .fix = {"tag/point"}},
            TopicChoice{.imu = {"imu/data=7"}, .fix = {"/tag/point:PointStamped=7"}}}) {
        const auto bag = read(file, choice);
        CHECK(test::difference(bag.log.events, events) == "");
        CHECK_THAT(joined(bag.notes), Contains("not used: ") &&
                                          Contains("/camera/imu (sensor_msgs/msg/Imu, 1 message)") &&
                                          Contains("/other (geometry_msgs/msg/PointStamped, 1 message)"));
      }
    }
    THEN("only the IMU is needed for its calibration") {
      const mcap::Reader reader(file);
      const auto bag =
          ros2::bag::read_bag(*ros2::bag::mcap_storage(reader), {.imu = {"/imu/data"}}, {}, false);
      CHECK(bag.log.events.size() == 200);
    }
    THEN("wrong choices name what there is") {
      CHECK_THROWS_WITH(read(file, {.imu = {"/imu"}}),
                        Contains("has no topic /imu (--imu-in); it has: ") && Contains("/tag/point"));
      CHECK_THROWS_WITH(read(file, {.imu = {"/tag/point"}}),
                        Contains("/tag/point is of type geometry_msgs/msg/PointStamped; --imu-in takes "
                                 "sensor_msgs/msg/Imu"));
      CHECK_THROWS_WITH(read(file, {.imu = {"/imu/data=7"}, .fix = {"/tag/point=8"}}),
                        Contains("belong to 2 beacons; choose one with --beacon: 7, 8"));
      CHECK_THROWS_WITH(read(file, {.imu = {"/imu/data=7"}, .fix = {"/tag/point=7"}}, BeaconAddress{9}),
                        Contains("no topic belongs to beacon 9; they belong to 7"));
      CHECK_THROWS_WITH(ros2::bag::choose_topics({.imu = {"/imu/data=70000"}}), Contains("--imu-in"));
      CHECK_THROWS_WITH(ros2::bag::choose_topics({.fix = {"/a", "/b"}}),
                        Contains("only one source of fixes"));
    }
  }
  GIVEN("no topic of these types") {
    test::write_bag(file, {test::message_of("/clock", ros2::Clock{}, 5)});
    THEN("the error lists the topics") {
      CHECK_THROWS_WITH(bus_log::read_sensor_log(file), Contains("has no message of sensor_msgs/msg/Imu") &&
                                                            Contains("/clock (rosgraph_msgs/msg/Clock"));
    }
  }
}

SCENARIO("topics are chosen where there are inputs of the bus too") {
  const TemporaryFolder folder;
  const auto file = folder / "both.mcap";
  GIVEN("a recording of the bus with a topic of ROS 2") {
    {
      test::BusRecording recording(file);
      const auto events = test::walk_events(2.0);
      for (const Event& event : events) {
        recording.write(event, static_cast<std::uint64_t>(available_at_ns(event)));
      }
      const auto schema = recording.writer().add_schema("sensor_msgs/msg/Imu", "ros2msg", "");
      const auto channel = recording.writer().add_channel(schema, "/imu/data", "cdr");
      const auto message = test::imu_message(std::get<ImuSample>(events.front()));
      const auto time_ns = static_cast<std::uint64_t>(message.received_ns);
      recording.writer().write({channel, 1, time_ns, time_ns, message.data});
    }
    THEN("the bus counts, unless a topic is chosen for the process") {
      CHECK(bus_log::read_sensor_log(file).events.size() > 200);
      ros2::bag::choose_topics({.imu = {"/imu/data"}});
      CHECK(bus_log::read_sensor_log(file).events.size() == 1);
      ros2::bag::choose_topics({});
    }
  }
}

SCENARIO("what drivers do is noticed as by the relay") {
  const TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  const auto events = test::walk_events(2.0);
  GIVEN("an accelerometer and a gyroscope apart, of which neither says so") {
    std::vector<RosMessage> messages;
    for (const auto* imu : test::each<ImuSample>(events)) {
      ImuSample force = *imu;
      force.angular_velocity_body_radps.setZero();
      ImuSample rate = *imu;
      rate.specific_force_body_mps2.setZero();
      messages.push_back(test::imu_message(force, "/accel"));
      messages.push_back(test::imu_message(rate, "/gyro"));
    }
    test::write_bag(file, messages);
    THEN("they are joined") {
      const auto bag = read(file, {.imu = {"/accel", "/gyro"}});
      CHECK(bag.log.events.size() == 200);
      CHECK(std::get<ImuSample>(bag.log.events[7]).specific_force_body_mps2 ==
            std::get<ImuSample>(bag.log.events[7]).specific_force_body_mps2);
      CHECK_THAT(joined(bag.notes), Contains("/gyro has the angular velocity of samples"));
      CHECK_THAT(joined(bag.log.warnings), Contains("/accel has messages without an angular velocity"));
    }
  }
  GIVEN("fixes with an unusable covariance in another frame, and messages with broken values and stamps") {
    auto messages = test::messages_of(events);
    std::erase_if(messages, [](const RosMessage& message) { return message.topic != "/imu/data"; });
    ros2::Covariance3 covariance = ros2::Covariance3::Identity();
    covariance(0, 1) = 0.5;  // not symmetric
    const auto& imu = std::get<ImuSample>(events.front());
    ros2::FrameNames frames;
    frames.map = "utm";
    messages.push_back(test::message_of(
        "/tag/pose", ros2::position_as_pose({1, 2, 3}, covariance, imu.sensor_time_ns, frames),
        imu.sensor_time_ns + 5));
    ImuSample broken = imu;
    broken.specific_force_body_mps2.x() = std::nan("");
    messages.push_back(test::imu_message(broken));
    ImuSample early = imu;
    early.sensor_time_ns = -4'000'000'000;
    messages.push_back(test::imu_message(early));
    messages.back().received_ns = imu.sensor_time_ns;
    test::write_bag(file, messages);
    THEN("each is told once, and the rest is used") {
      const auto bag = read(file);
      CHECK(bag.log.events.size() == 201);
      const std::string warnings = joined(bag.log.warnings);
      CHECK_THAT(warnings, Contains("/tag/pose has an unusable covariance") && Contains("not symmetric"));
      CHECK_THAT(warnings, Contains("in frame 'utm': they are used as if in 'map'"));
      CHECK_THAT(warnings, Contains("2 messages not used: of /imu/data, a value is not finite or a stamp"));
    }
  }
  GIVEN("messages without a stamp") {
    auto messages = test::messages_of(events);
    ImuSample unstamped = std::get<ImuSample>(events.front());
    const TimeNs received_ns = unstamped.sensor_time_ns;
    unstamped.sensor_time_ns = 0;
    messages = {test::imu_message(unstamped)};
    messages.back().received_ns = received_ns;
    test::write_bag(file, messages);
    THEN("they count as measured when they were received, which is said with their number") {
      const auto bag = read(file);
      REQUIRE(bag.log.events.size() == 1);
      CHECK(available_at_ns(bag.log.events[0]) == received_ns);
      CHECK_THAT(joined(bag.log.warnings), Contains("/imu/data has messages without a stamp") &&
                                               Contains("1 message of /imu/data without a stamp"));
    }
  }
}

SCENARIO("IMU stamps far ahead are left out of a bag as of a folder") {
  const TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  auto messages = test::messages_of(test::walk_events(20.0));
  const std::size_t count = messages.size();
  ImuSample ahead;
  ahead.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
  for (std::size_t i = 500; i < 502; ++i) {
    ahead.sensor_time_ns = messages[i].received_ns + 5'000'000'000;
    messages[i] = test::imu_message(ahead);
    messages[i].received_ns -= 5'000'000'000;
  }
  test::write_bag(file, messages);
  const auto log = bus_log::read_sensor_log(file);
  CHECK(log.events.size() == count - 2);
  CHECK(sequence_of(log.events.back()) == log.events.size());
  CHECK_THAT(joined(log.warnings), Contains("2 of ") && Contains(" IMU samples are left out"));
}

SCENARIO("velocities whose clock is not that of the IMU are named") {
  const TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  GIVEN("a drive of six seconds with velocities whose stamps are 0.3 s ahead, or right") {
    const double ahead_s = GENERATE(0.3, 0.0);
    std::vector<RosMessage> messages;
    const std::string imu_frame = "imu_link";
    for (int i = 0; i < 60; ++i) {
      const TimeNs time_ns = 1'700'000'000'000'000'000 + i * TimeNs{100'000'000};
      ImuSample imu;
      imu.sensor_time_ns = time_ns;
      imu.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
      messages.push_back(test::imu_message(imu));
      ros2::TwistStamped twist{};
      twist.header = ros2::header_of(time_ns + to_ns(ahead_s), imu_frame);
      messages.push_back(test::message_of("/wheel", twist, time_ns + 2'000'000));
    }
    test::write_bag(file, messages);
    THEN("the recording is said to have two clocks, or is not") {
      const auto bag = read(file, {.aiding = {{AidingInput::Kind::twist, {"/wheel:TwistStamped"}}}});
      const bool is_named =
          joined(bag.log.warnings).find("/wheel has stamps that are 0.298 s newer than those of /imu/data") !=
          std::string::npos;
      CHECK(is_named == (ahead_s > 0));
    }
  }
  GIVEN("a walk of five seconds whose fixes have stamps 0.3 s ahead, or right") {
    const double ahead_s = GENERATE(0.3, 0.0);
    auto events = test::walk_events(5.0);
    for (Event& event : events) {
      if (auto* const fix = std::get_if<UltrasonicFix>(&event)) fix->emission_time_ns += to_ns(ahead_s);
    }
    test::write_bag(file, test::messages_of(events));
    THEN("stamps after their arrival are named, and the latency of fixes is not") {
      const std::string warnings = joined(read(file).log.warnings);
      if (ahead_s > 0) {
        CHECK_THAT(warnings,
                   Contains("/tag/point has stamps that are 0.2") && Contains(" s newer than those of"));
      } else {
        CHECK(warnings.empty());
      }
    }
  }
}

SCENARIO("velocities and truth are those of the base") {
  const TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  GIVEN("an IMU 1 m ahead of the base and turned by 90°, and a base that turns on the spot at 0.5 rad/s") {
    constexpr TimeNs start_ns = 1'700'000'000'000'000'000;
    const std::string base = "base_link";  // messages borrow them
    const std::string imu_frame = "imu_link";
    const std::string odom = "odom";
    ImuSample imu;
    imu.specific_force_body_mps2 = {0, 0, standard_gravity_mps2};
    std::vector<RosMessage> messages;
    const ros2::Transform mount{{1, 0, 0},
                                Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()))};
    std::vector<ros2::TransformStamped> transforms{ros2::transform(mount, start_ns, base, imu_frame)};
    ros2::TFMessage tf{};
    ros2::borrow_sequence(tf.transforms, transforms);
    for (TimeNs i = 0; i < 10; ++i) {
      const TimeNs time_ns = start_ns + i * 10'000'000;
      imu.sensor_time_ns = time_ns;
      messages.push_back(test::imu_message(imu));
      ros2::Odometry odometry{};
      odometry.header = ros2::header_of(time_ns, odom);
      odometry.child_frame_id = ros2::borrow_string(base);
      odometry.pose.pose.position = {3, 4, 0};
      odometry.pose.pose.orientation = {0, 0, 0, 1};
      odometry.twist.twist.angular.z = 0.5;
      messages.push_back(test::message_of("/odom", odometry, time_ns));
    }
    messages.push_back(test::message_of("/tf_static", tf, start_ns));
    test::write_bag(file, messages);
    THEN("they are moved to the IMU") {
      const auto bag = read(file, {.aiding = {{AidingInput::Kind::odometry, {"/odom"}}}, .truth = "/odom"});
      CHECK(joined(bag.log.warnings).empty());
      REQUIRE(bag.log.truth.size() == 10);
      const TruthSample& truth = bag.log.truth[3];
      CHECK(truth.position_world_m.isApprox(Vector3d(4, 4, 0)));
      CHECK(truth.q_body_to_world.angularDistance(mount.rotation) < 1e-9);
      CHECK(truth.velocity_world_mps.isApprox(Vector3d(0, 0.5, 0)));
      const auto twist = std::ranges::find_if(
          bag.log.events, [](const Event& event) { return std::holds_alternative<TwistSample>(event); });
      REQUIRE(twist != bag.log.events.end());
      CHECK(std::get<TwistSample>(*twist).velocity_body_mps.isApprox(Vector3d(0.5, 0, 0)));
    }
    THEN("velocities of another frame are turned and moved too, and unused if it is not connected") {
      const std::string wheel = "wheel_link";
      const std::string map = "map";
      const ros2::Transform wheel_in_base{{0, 0.5, 0}, mount.rotation};
      transforms.push_back(ros2::transform(wheel_in_base, start_ns, base, wheel));
      ros2::borrow_sequence(tf.transforms, transforms);
      messages.push_back(test::message_of("/tf_static", tf, start_ns));
      for (const std::string& frame : {wheel, map}) {
        ros2::TwistStamped twist{};
        twist.header = ros2::header_of(start_ns + 50'000'000, frame);
        twist.twist.linear.x = 0.1;
        twist.twist.angular.z = 0.5;
        messages.push_back(test::message_of("/wheel", twist, start_ns + 50'000'000));
      }
      const auto frames_file = folder / "frames_0.mcap";
      test::write_bag(frames_file, messages);
      const auto bag = read(frames_file, {.aiding = {{AidingInput::Kind::twist, {"/wheel:TwistStamped"}}}});
      CHECK(kinds_of(bag.log.events).at(3) == 1);
      // At the wheel 0.1 m/s along y of the base; the IMU is (1, -0.5) m from it, and looks along y.
      CHECK(first<TwistSample>(bag.log.events)
                .velocity_body_mps.isApprox(Vector3d(0.1 + 0.5 * 1, -0.5 * 0.5, 0)));
      CHECK_THAT(joined(bag.log.warnings),
                 Contains("/tf_static does not connect their frame 'map' with the base"));
    }
    THEN("their poses are fixes and headings, and one topic may have both kinds of input") {
      TopicChoice choice{.aiding = {{AidingInput::Kind::odometry, {"/odom"}},
                                    {AidingInput::Kind::pose, {"/odom:Odometry"}}}};
      CHECK_THROWS_WITH(read(file, choice),
                        Contains("--pose-in /odom: none of its 10 messages is used: /tf_static does not "
                                 "connect their frame 'odom' with the map"));
      choice.map_frame = "odom";
      const auto bag = read(file, choice);
      CHECK(kinds_of(bag.log.events) == std::map<std::size_t, int>{{0, 10}, {1, 10}, {2, 10}, {3, 10}});
      CHECK(first<UltrasonicFix>(bag.log.events).position_world_m == Vector3d(3, 4, 0));
      CHECK(first<UltrasonicFix>(bag.log.events).point_body_m.isApprox(Vector3d(0, 1, 0)));
      CHECK(first<PairHeading>(bag.log.events).heading_world_rad == Approx(std::numbers::pi / 2));
    }
    THEN("headings of a compass and of the IMU itself, and speeds of wheels, are used") {
      std::vector<std::string> names{"left", "right"};
      std::vector<char*> joints{names[0].data(), names[1].data()};
      std::vector<double> speeds{10, 10};
      ros2::JointState state{};
      state.header = ros2::header_of(start_ns, base);
      ros2::borrow_sequence(state.name, joints);
      ros2::borrow_sequence(state.velocity, speeds);
      ros2::Imu compass = ros2::raw_imu(imu, start_ns, {}, {});
      compass.orientation = {0, 0, 0, 1};
      compass.orientation_covariance[0] = compass.orientation_covariance[8] = 0.01;
      const TimeNs later_ns = start_ns + 200'000'000;
      messages.push_back(test::message_of("/yaw", ros2::Float64{.data = 30}, later_ns));
      messages.push_back(test::message_of("/joints", state, later_ns));
      messages.push_back(test::message_of("/compass", compass, later_ns));
      const auto more = folder / "more_0.mcap";
      test::write_bag(more, messages);
      const ros2::Wheels wheels{{"left"}, {"right"}, 0.1, 0.5};
      CHECK_THROWS_WITH(
          read(more, {.imu = {"/imu/data"},
                      .aiding = {{AidingInput::Kind::wheels, {"/joints"}}},
                      .wheels = ros2::Wheels{{"front_left"}, {"right"}, 0.1, 0.5}}),
          Contains("--wheel-in /joints: none of its 1 message is used: they have no joint 'front_left' of "
                   "--wheels; they have: left, right"));
      const auto of_yaw = read(more, {.imu = {"/imu/data"},
                                      .aiding = {{AidingInput::Kind::heading, {"/yaw:Float64"}},
                                                 {AidingInput::Kind::wheels, {"/joints"}}},
                                      .wheels = wheels});
      // The base faces 30°, and the IMU another 90°.
      CHECK(first<PairHeading>(of_yaw.log.events).heading_world_rad == Approx(2 * std::numbers::pi / 3));
      CHECK(first<PairHeading>(of_yaw.log.events).emission_time_ns == later_ns);
      CHECK(first<TwistSample>(of_yaw.log.events).velocity_body_mps.isApprox(Vector3d(0, -1, 0)));
      // The IMU is then the other topic of its type.
      const auto of_compass = read(more, {.aiding = {{AidingInput::Kind::heading, {"/compass"}}}});
      CHECK(kinds_of(of_compass.log.events) == std::map<std::size_t, int>{{0, 10}, {2, 1}});
      CHECK(first<PairHeading>(of_compass.log.events).heading_world_rad == Approx(0).margin(1e-9));
      CHECK(first<PairHeading>(of_compass.log.events).std_rad == Approx(0.1));
      CHECK_THROWS_WITH(
          read(more, {.imu = {"/imu/data"}, .aiding = {{AidingInput::Kind::wheels, {"/joints"}}}}),
          Contains("--wheel-in and --wheels need each other"));
      CHECK_THROWS_WITH(
          read(more, {.imu = {"/imu/data"}, .aiding = {{AidingInput::Kind::heading, {"/joints"}}}}),
          Contains("/joints is of type sensor_msgs/msg/JointState; --heading-in takes sensor_msgs/msg/Imu"));
    }
    THEN("a tag on the left of the base is seen from the IMU") {
      UltrasonicFix at_start;
      at_start.emission_time_ns = at_start.received_time_ns = start_ns;
      messages.push_back(test::fix_message(at_start));
      const auto tag_file = folder / "tag_0.mcap";
      test::write_bag(tag_file, messages);
      const auto bag = read(tag_file, {.fix = {"/tag/point@0,1,0"}});
      const auto fix = std::ranges::find_if(
          bag.log.events, [](const Event& event) { return std::holds_alternative<UltrasonicFix>(event); });
      REQUIRE(fix != bag.log.events.end());
      CHECK(std::get<UltrasonicFix>(*fix).point_body_m.isApprox(Vector3d(1, 1, 0)));
      CHECK_THROWS_WITH(read(tag_file, {.fix = {"/tag/point@tag_link"}}),
                        Contains("--fix-in /tag/point: none of its 1 message is used: /tf_static does not "
                                 "connect 'tag_link' with the base"));
    }
    THEN("the slash of old drivers before a frame is ignored, and a later place of the IMU is told") {
      const std::string old_name = "/" + imu_frame;
      ros2::FrameNames frames;
      frames.imu = old_name;
      messages.front() = test::message_of("/imu/data", ros2::raw_imu(imu, start_ns, frames, {}), start_ns);
      const auto slash_file = folder / "slash_0.mcap";
      test::write_bag(slash_file, messages);
      const TopicChoice choice{.truth = "/odom", .base_frame = "/base_link"};
      CHECK(read(slash_file, choice).log.truth[3].position_world_m.isApprox(Vector3d(4, 4, 0)));
      transforms.front().transform.translation.x = 2;
      messages.push_back(test::message_of("/tf_static", tf, start_ns + 50'000'000));
      const auto moved_file = folder / "moved_0.mcap";
      test::write_bag(moved_file, messages);
      const auto bag = read(moved_file, choice);
      CHECK(bag.log.truth[3].position_world_m.isApprox(Vector3d(5, 4, 0)));
      CHECK_THAT(joined(bag.log.warnings), Contains("/tf_static moves imu_link: the latest place counts"));
    }
    THEN("velocities without a stamp are told") {
      ros2::TwistStamped twist{};
      twist.header = ros2::header_of(0, base);
      messages.push_back(test::message_of("/wheel", twist, start_ns + 50'000'000));
      const auto unstamped_file = folder / "unstamped_0.mcap";
      test::write_bag(unstamped_file, messages);
      const auto bag =
          read(unstamped_file, {.aiding = {{AidingInput::Kind::twist, {"/wheel:TwistStamped"}}}});
      CHECK_THAT(joined(bag.log.warnings), Contains("/wheel has messages without a stamp"));
    }
    THEN("without a transform they count as those of the IMU, which is told") {
      const auto bag = read(file, {.truth = "/odom", .base_frame = "chassis"});
      CHECK(bag.log.truth[3].position_world_m == Vector3d(3, 4, 0));
      CHECK_THAT(joined(bag.log.warnings),
                 Contains("has no transform from chassis to 'imu_link' in /tf_static"));
    }
  }
}

SCENARIO("recordings of rosbag2 that are compressed, damaged or wrong") {
  const TemporaryFolder folder;
  const auto file = folder / "drive_0.mcap";
  const auto events = test::walk_events(2.0);
  auto messages = test::messages_of(events);
  GIVEN("messages that are compressed one by one") {
    mcap::Compressor compressor(mcap::Compression::zstd);
    for (RosMessage& message : messages) {
      std::vector<std::byte> compressed(compressor.bound(message.data.size()));
      compressed.resize(compressor.compress(message.data, compressed));
      message.data = std::move(compressed);
    }
    test::write_bag(file, messages);
    THEN("they are expanded") {
      CHECK(test::difference(read(file).log.events, events) == "");
    }
  }
  GIVEN("a file that is cut") {
    test::write_bag(file, messages);
    std::filesystem::resize_file(file, std::filesystem::file_size(file) * 2 / 3);
    THEN("what is left is read, and the cut is told") {
      const auto bag = read(file);
      CHECK(bag.log.events.size() < events.size());
      CHECK_FALSE(bag.log.warnings.empty());
    }
  }
  GIVEN("a message of another type than its schema says") {
    messages[5].data.resize(40);
    test::write_bag(file, messages);
    THEN("it alone is left out, and counted") {
      const auto bag = read(file);
      CHECK(bag.log.events.size() == events.size() - 1);
      CHECK_THAT(joined(bag.log.warnings),
                 Contains("1 message not used: of /imu/data, no serialized sensor_msgs/msg/Imu"));
    }
  }
  GIVEN("a topic in another encoding") {
    test::write_bag(file, messages, {.message_encoding = "json"});
    THEN("the error names it") {
      CHECK_THROWS_WITH(read(file, {.imu = {"/imu/data"}}),
                        Contains(R"(/imu/data has the encoding "json" instead of "cdr")"));
    }
  }
}

}  // namespace bag_log_test
