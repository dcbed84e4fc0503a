#include "ros2_options.hpp"

#include "choice.hpp"
#include "imu_meaning_option.hpp"
#include "north_option.hpp"
#include "ros2/inputs/wheels_file.hpp"
#include "run.hpp"

namespace sonopose::apps {
namespace {

void add_node_options(CommandLine& app, Ros2Options& options) {
  const char* const group = "ROS 2 node";
  app.add_option("--name", options.node.name, "Name of the node").capture_default_str().group(group);
  app.add_option("--namespace", options.node.name_space, "Namespace of the node")
      .capture_default_str()
      .group(group);
  app.add_option("-r,--remap", options.remap,
                 "Remap a name, as in ROS 2: /hedge_7/odom:=/odom; may be repeated")
      .type_name("FROM:=TO")
      .group(group);
  app.add_flag("--use-sim-time", options.use_sim_time,
               "Use the time of the topic /clock, of a simulator or of a recording that is played back")
      .group(group);
  app.add_option_function<std::string>(
         "--ros-distro", [&options](const std::string& name) { options.distro = ros2::distro_named(name); },
         "ROS 2 distribution to be compatible with: humble, or jazzy for Iron and later; the names of other "
         "distributions work too (default: ROS_DISTRO, else that of the other nodes)")
      .check(one_of(ros2::distro_names()))
      .option_text("humble|jazzy")
      .group(group);
}

void add_services_option(CommandLine& app, Ros2Options& options) {
  using ros2::relay::ServicesMode;
  add_choice<ServicesMode>(
      app, "--services", options.services,
      {{"auto", ServicesMode::automatic}, {"on", ServicesMode::on}, {"off", ServicesMode::off}},
      "Offer the parameter services, which only clients on Cyclone DDS can use; auto: unless a process on "
      "Fast DDS is present")
      .group("ROS 2 node");
}

void add_frame_options(CommandLine& app, Ros2Options& options) {
  const char* const group = "Frames";
  const auto frame = [&](const char* name, std::string& value, const char* what) {
    app.add_option(name, value, what).capture_default_str().type_name("FRAME").group(group);
  };
  frame("--map-frame", options.output.frames.map,
        "Frame of the beacons' world; {address} is replaced by the beacon's address");
  frame("--odom-frame", options.output.frames.odom, "Frame of another source's odometry");
  frame("--base-frame", options.output.frames.base, "Frame of the robot");
  frame("--imu-frame", options.output.frames.imu, "Frame of the IMU");
  app.add_option("--mount", options.mount, "Pose of the IMU on the robot: x y z (m) roll pitch yaw (deg)")
      .type_name("N")
      .group(group);
  app.add_flag("--mount-from-tf", options.output.mount_from_tf,
               "Use the transform from base to IMU that another node publishes on /tf_static")
      .group(group);
  add_choice<ros2::relay::TfMode>(
      app, "--tf", options.output.tf,
      {{"map_base", ros2::relay::TfMode::map_base},
       {"map_odom", ros2::relay::TfMode::map_odom},
       {"off", ros2::relay::TfMode::off}},
      "Transform to publish: map to base; map to odom, if another source publishes odom to base; or none")
      .group(group);
}

void add_static_option(CommandLine& app, Ros2Options& options) {
  add_choice<std::optional<bool>>(
      app, "--tf-static", options.output.tf_static, {{"on", true}, {"off", false}},
      "Publish the mount, base to IMU (default: unless --tf is off, or with --mount-from-tf)")
      .group("Frames");
}

void add_message_options(CommandLine& app, Ros2Options& options) {
  const char* const group = "Messages";
  app.add_option("--addresses", options.addresses,
                 "Relay only these beacons: 7, 7-131 or 7-131,200 (default: all)")
      .type_name("LIST")
      .group(group);
  app.add_option("--max-beacons", options.max_beacons,
                 "Relay at most this many beacons at a time: the first ones that are heard")
      .check(number_between(std::size_t{1}, ros2::relay::max_relayed_beacons))
      .type_name("N")
      .capture_default_str()
      .group(group);
  app.add_option("--beacon-namespace", options.output.beacon_namespace,
                 "Namespace of a beacon's topics; '' (for a single beacon): the node's namespace")
      .capture_default_str()
      .group(group);
  app.add_option_function<std::vector<std::string>>(
         "--topics",
         [&options](const std::vector<std::string>& topics) {
           options.output.topics = {topics.begin(), topics.end()};
         },
         "Topics of a beacon to publish (default: all); --tf, --tf-static and --path select the others")
      .delimiter(',')
      .check(one_of(ros2::beacon_topics()))
      .option_text(fmt::format("{}", fmt::join(ros2::beacon_topics(), ",")))
      .group(group);
  app.add_option("--rate", options.output.rate_hz,
                 "Thin poses (odom, pose) and transforms to this rate, Hz; 0 publishes each one")
      .check(number_between(0.0, 1e6))
      .capture_default_str()
      .type_name("HZ")
      .group(group);
  add_choice<ros2::relay::FixMessage>(
      app, "--fix-message", options.output.fix,
      {{"pose", ros2::relay::FixMessage::pose}, {"point", ros2::relay::FixMessage::point}},
      "Publish fixes as PoseWithCovarianceStamped or as PointStamped")
      .group(group);
  app.add_option("--path", options.output.path_s, "Publish the path of the last S seconds")
      .check(number_between(0.0, 3600.0))
      .type_name("S")
      .group(group);
  const auto deviation = [&](const char* name, double& value, double most, const char* what) {
    app.add_option(name, value, what).check(number_between(1e-12, most)).capture_default_str().group(group);
  };
  deviation("--gyro-std", options.output.noise.gyro_std_radps, 1e3,
            "Standard deviation of the gyroscope, rad/s");
  deviation("--accel-std", options.output.noise.accel_std_mps2, 1e3,
            "Standard deviation of the accelerometer, m/s^2");
  deviation("--magnetic-std", options.output.noise.magnetic_std_t, 1e3,
            "Standard deviation of the magnetometer, T");
  deviation("--tilt-std", options.output.noise.tilt_std_deg, 180,
            "Standard deviation of roll and pitch, deg");
}

void add_aiding_options(CommandLine& app, Ros2Options& options) {
  const auto add = [&](const char* name, std::vector<std::string>& values, bool has_types, const char* what) {
    app.add_option(name, values, what)
        .option_text(has_types ? "TOPIC[:TYPE]=ADDRESS" : "TOPIC=ADDRESS")
        .group("From ROS 2");
  };
  add("--odom-in", options.odom_in, false,
      "Use the twist of nav_msgs/Odometry (wheels) as velocities of a beacon: /odom=7");
  add("--twist-in", options.twist_in, true,
      "Use TwistWithCovarianceStamped, or TwistStamped, likewise: /wheel/twist:TwistStamped=7");
  add("--wheel-in", options.wheel_in, false,
      "Use the wheel speeds of sensor_msgs/JointState likewise, with --wheels: /joint_states=7");
  app.add_option("--wheels", options.wheels,
                 "File with the joints of a differential drive, radius_m and track_m, for --wheel-in")
      .check(readable_by(ros2::read_wheels))
      .type_name("FILE")
      .group("From ROS 2");
  add("--heading-in", options.heading_in, true,
      "Use the orientation of sensor_msgs/Imu, PoseWithCovarianceStamped, or Float64 (degrees) as headings "
      "of "
      "a beacon: /compass=7, /yaw:Float64=7");
  add("--pose-in", options.pose_in, true,
      "Use PoseWithCovarianceStamped, PoseStamped or Odometry as fixes and headings of a beacon: "
      "/vision/odom:Odometry=7");
  add("--set-pose-in", options.set_pose_in, true,
      "Start the estimate of a beacon again at each PoseWithCovarianceStamped, as of RViz, or request of the "
      "service SetPose: /initialpose=7, /set_pose:SetPose=7");
}

void add_input_options(CommandLine& app, Ros2Options& options) {
  const char* const group = "From ROS 2";
  app.add_option("--imu-in", options.imu_in,
                 "Use a driver's sensor_msgs/Imu as the samples of a beacon: /imu/data=7; or PX4's "
                 "/fmu/out/sensor_combined:SensorCombined=7")
      .option_text("TOPIC[:TYPE]=ADDRESS")
      .group(group);
  add_choice<std::optional<ImuMeaning>>(
      app, "--imu-meaning", options.imu_meaning, imu_meaning_choices(),
      "What the samples of --imu-in are: the value at their instant, or the mean since the previous one; "
      "the message does not say (default: unknown)")
      .group(group);
  app.add_option(
         "--fix-in", options.fix_in,
         "Use PointStamped or PoseWithCovarianceStamped as the fixes of a beacon: /tag/pose=7; the type is "
         "that of the topic's first publisher, or TYPE. PLACE is the tag's on the robot, a frame of tf or "
         "x,y,z (m): several tags of one beacon need it")
      .option_text("TOPIC[:TYPE]=ADDRESS[@PLACE]")
      .group(group);
  add_aiding_options(app, options);
}

void add_autopilot_options(CommandLine& app, Ros2Options& options) {
  const char* const group = "Messages";
  auto px4 = app.add_option("--px4", options.px4,
                            "Send poses to PX4: on NAMESPACE/fmu/in/vehicle_visual_odometry; "
                            "'/' without a namespace. 30 Hz, unless --rate")
                 .type_name("NAMESPACE")
                 .group(group);
  app.add_option("--ardupilot", options.ardupilot,
                 "Send poses to ArduPilot: on NAMESPACE/tf; usually /ap. 30 Hz, unless --rate")
      .type_name("NAMESPACE")
      .excludes(px4)
      .group(group);
  add_north_option(app, options.north_rad).group(group);
}

/// Describes a different default: other programs use loopback, the relay the network of the ROS 2 nodes.
void describe_network(CommandLine& app) {
  app.option("--network")
      .option_text("loopback|lan")
      .description(
          "loopback: only this machine; lan: the interface of the default route, "
          "without any bridge or fusion on loopback; CYCLONEDDS_URI overrides both "
          "(default: from the environment variables of ROS 2)");
}

}  // namespace

void add_ros2_options(CommandLine& app, Ros2Options& options) {
  describe_network(app);
  add_node_options(app, options);
  add_services_option(app, options);
  add_message_options(app, options);
  add_frame_options(app, options);
  add_static_option(app, options);
  add_input_options(app, options);
  add_autopilot_options(app, options);
}

}  // namespace sonopose::apps
