"""Commands and nodes of a real ROS 2 beside the relay: real_ros2.py BIN_FOLDER CASE

SONOPOSE_ROS2_PREFIX is the prefix of an installation with rmw_cyclonedds_cpp, such as /opt/ros/humble. Without it, or
without a package that the case needs, prints "skipped: ...".
"""

import os
import signal
import subprocess
import sys
import tempfile
import time

PREFIX = os.environ.get("SONOPOSE_ROS2_PREFIX")
if not PREFIX:
    print("skipped: no ROS 2; SONOPOSE_ROS2_PREFIX=/opt/ros/humble tests with one")
    sys.exit(0)
if "SONOPOSE_ROS2_IS_SOURCED" not in os.environ:
    os.environ["SONOPOSE_ROS2_IS_SOURCED"] = "1"
    os.execv("/bin/bash", ["bash", "-c", '. "$0/setup.bash" && exec /usr/bin/python3 "$@"', PREFIX, *sys.argv])

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "support"))
from reserve_domain import reserve_domain  # noqa: E402

LIMIT_S = 180  # bound of each wait, which ends with its event
SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def check(condition, what):
    if not condition:
        raise AssertionError(what)
    print("ok:", what)


def wait_for(what, function):
    """Polls the function and returns its value as soon as it is true."""
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        value = function()
        if value:
            print("ok:", what)
            return value
        time.sleep(0.1)
    raise AssertionError(f"{what}: not within {LIMIT_S} s")


class System:
    """A bridge with the simulator, a fusion and the relay, in a domain of their own."""

    def __init__(self, binaries):
        self.binaries = binaries
        self.lock, domain = reserve_domain()
        self.folder = tempfile.TemporaryDirectory()
        self.running = []
        os.environ.update(
            ROS_DOMAIN_ID=str(domain), RMW_IMPLEMENTATION="rmw_cyclonedds_cpp", ROS_LOG_DIR=self.folder.name,
            CYCLONEDDS_URI="file://" + os.path.join(SOURCE, "config", "cyclonedds-loopback.xml"))

    def start(self, name, *arguments):
        """Starts a program of the project."""
        return self.run([os.path.join(self.binaries, "sonopose-" + name), *arguments])

    def run(self, command):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        self.running.append(process)
        return process

    def end(self):
        subprocess.run(["ros2", "daemon", "stop"], stdout=subprocess.DEVNULL, check=False)
        for process in self.running:
            process.send_signal(signal.SIGINT)
        for process in self.running:
            process.wait(LIMIT_S)
        self.folder.cleanup()


def ros2(*arguments):
    """Output of a command of ROS 2. Fails if it warns of native topics, which are none of its business."""
    done = subprocess.run(["ros2", *arguments], capture_output=True, text=True, timeout=LIMIT_S, check=False)
    if "sonopose::" in done.stderr:
        raise AssertionError(done.stderr)
    return done.stdout + done.stderr


def start_simulation(system):
    system.start("bridge")
    system.start("fusion")
    system.start("ros2")


def topics(system):
    """GIVEN a relay with a simulated beacon THEN ros2 node and ros2 topic show its node, types and values."""
    start_simulation(system)
    wait_for("the node is listed", lambda: "/sonopose" in ros2("node", "list").split())
    wait_for("the topics are listed with their types",
             lambda: "/hedge_7/odom [nav_msgs/msg/Odometry]" in ros2("topic", "list", "-t"))
    check("Node name: sonopose" in ros2("topic", "info", "-v", "/hedge_7/odom"), "the publisher belongs to the node")
    check("/hedge_7/imu/data: sensor_msgs/msg/Imu" in ros2("node", "info", "/sonopose"), "the node has its publishers")
    import yaml
    message = next(yaml.safe_load_all(ros2("topic", "echo", "--once", "--full-length", "/hedge_7/odom")))
    check(message["header"]["frame_id"] == "map" and message["child_frame_id"] == "base_link", "odom has its frames")
    check(len(message["pose"]["covariance"]) == 36 and message["pose"]["covariance"][0] > 0, "odom has a covariance")
    length = sum(each * each for each in message["pose"]["pose"]["orientation"].values())
    check(abs(length - 1) < 1e-6, "its quaternion is normalised")
    command = subprocess.Popen(["ros2", "topic", "hz", "/hedge_7/imu/data_raw"], stdout=subprocess.PIPE, text=True)
    check(any("average rate" in line for line in command.stdout), "ros2 topic hz measures a rate")
    command.kill()


def parameters(system):
    """GIVEN a relay and a fusion THEN ros2 param and ros2 service change settings and reset the engines."""
    start_simulation(system)
    wait_for("the settings are parameters",
             lambda: "beacon_7.delay.processing_s" in ros2("param", "list", "/sonopose").split())
    check("successful" in ros2("param", "set", "/sonopose", "beacon_7.delay.processing_s", "0.08"), "one is set")
    check("0.08" in ros2("param", "get", "/sonopose", "beacon_7.delay.processing_s"), "it has the new value")
    check("read-only" in ros2("param", "set", "/sonopose", "map_frame", "other"), "an option is read-only")
    check("out of range" in ros2("param", "set", "/sonopose", "delay.processing_s", "900.0"), "a wrong one is refused")
    dumped = os.path.join(system.folder.name, "sonopose.yaml")
    with open(dumped, "w", encoding="utf-8") as file:
        file.write(ros2("param", "dump", "/sonopose"))
    import yaml
    with open(dumped, encoding="utf-8") as file:
        values = yaml.safe_load(file)["/sonopose"]["ros__parameters"]
    check(values["beacon_7"]["delay"]["processing_s"] == 0.08, "dump has the setting")
    check(values["map_frame"] == "map" and values["use_sim_time"] is False, "dump has the options of the relay")
    check("success=True" in ros2("service", "call", "/sonopose/reset", "std_srvs/srv/Trigger"), "reset succeeds")


class Listener:
    """A node that keeps the messages of some topics."""

    def __init__(self, subscriptions):
        import rclpy
        rclpy.init()
        self.node = rclpy.create_node("listener")
        self.messages = {topic: [] for topic in subscriptions}
        for topic, kind in subscriptions.items():
            self.node.create_subscription(kind, topic, self.messages[topic].append, 1000)

    def wait_for(self, what, function):
        """Receives messages until the function returns something true, and returns that."""
        import rclpy
        end = time.monotonic() + LIMIT_S
        while time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.1)
            value = function()
            if value:
                print("ok:", what)
                return value
        raise AssertionError(f"{what}: not within {LIMIT_S} s")


def time_s(message):
    return message.header.stamp.sec + message.header.stamp.nanosec * 1e-9


def transforms(system):
    """GIVEN a relay with a mount WHEN a node looks up map -> imu_link THEN its rotation is that of imu/data, and its
    translation is the position of odom and the mount."""
    import importlib.util
    if importlib.util.find_spec("tf2_ros") is None:
        print("skipped: SONOPOSE_ROS2_PREFIX has no tf2_ros")
        return
    import rclpy.time
    import tf2_ros
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import Imu
    system.start("bridge")
    system.start("fusion")
    system.start("ros2", "--mount", "0.3", "0", "0.1", "0", "0", "90")
    listener = Listener({"/hedge_7/odom": Odometry, "/hedge_7/imu/data": Imu})
    buffer = tf2_ros.Buffer()
    tf2_ros.TransformListener(buffer, listener.node)

    def found():
        imus = {time_s(each): each for each in listener.messages["/hedge_7/imu/data"]}
        for odom in listener.messages["/hedge_7/odom"]:
            stamp = rclpy.time.Time.from_msg(odom.header.stamp)
            if time_s(odom) in imus and buffer.can_transform("map", "imu_link", stamp):
                return odom, imus[time_s(odom)], buffer.lookup_transform("map", "imu_link", stamp).transform
        return None

    odom, imu, transform = listener.wait_for("tf2 finds the transform of a pose", found)
    x, y, z, w = (getattr(odom.pose.pose.orientation, axis) for axis in "xyzw")
    # The first and third column of the rotation of the base.
    x_axis = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]
    z_axis = [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]
    for i, axis in enumerate("xyz"):
        expected = getattr(odom.pose.pose.position, axis) + 0.3 * x_axis[i] + 0.1 * z_axis[i]
        check(abs(getattr(transform.translation, axis) - expected) < 1e-6, f"{axis} is that of the mounted IMU")
    dot = sum(getattr(transform.rotation, axis) * getattr(imu.orientation, axis) for axis in "xyzw")
    check(abs(abs(dot) - 1) < 1e-9, "the rotation is that of the IMU")


def bags(system):
    """GIVEN a recording of IMU and fixes by ros2 bag WHEN it is played as the sensors of another beacon, with --clock
    and a relay with --use-sim-time THEN its poses have the stamps of the recording, and agree with those before."""
    if "record" not in ros2("bag", "--help"):
        print("skipped: SONOPOSE_ROS2_PREFIX has no ros2bag")
        return
    from nav_msgs.msg import Odometry
    system.start("fusion")
    before = [system.start("bridge"), system.start("ros2")]
    live, played = "/hedge_7/odom", "/hedge_42/odom"
    listener = Listener({live: Odometry, played: Odometry})
    poses = listener.messages[live]
    listener.wait_for("there are poses", lambda: poses)
    bag = os.path.join(system.folder.name, "bag")
    before.append(system.run(["ros2", "bag", "record", "-o", bag, "/hedge_7/imu/data_raw", "/hedge_7/fix"]))
    listener.wait_for("it records", lambda: listener.node.count_subscribers("/hedge_7/fix") > 0)
    begin_s = time_s(poses[-1])
    listener.wait_for("20 s are recorded", lambda: time_s(poses[-1]) > begin_s + 20)
    for process in reversed(before):
        process.send_signal(signal.SIGINT)
        process.wait(LIMIT_S)
    recorded = {time_s(each): each.pose.pose.position for each in poses}
    system.start("ros2", "--use-sim-time", "--imu-in", "/hedge_7/imu/data_raw=42", "--fix-in", "/hedge_7/fix=42")
    listener.wait_for("the relay reads", lambda: listener.node.count_subscribers("/hedge_7/imu/data_raw") > 0)
    player = system.run(["ros2", "bag", "play", "--clock", "100", bag])
    listener.wait_for("it was played", lambda: player.poll() is not None)
    errors = [(position.x - each.pose.pose.position.x) ** 2 + (position.y - each.pose.pose.position.y) ** 2
              for each in listener.messages[played] if (position := recorded.get(time_s(each)))]
    check(len(errors) > 100, "the poses have the stamps of the recording")
    check(sorted(errors[-100:])[50] < 0.2 ** 2, "the positions agree within 20 cm")


def robots(system):
    """GIVEN two robots with their relays in two namespaces WHEN one relay is killed, and the engines of the other are
    reset THEN its node disappears, and the other resets its own beacon alone."""
    system.start("bridge")
    system.start("bridge", "--address", "8", "--seed", "2")
    system.start("fusion")
    names = [f"/robot_{address}/sonopose" for address in (7, 8)]
    relays = [system.start("ros2", "--namespace", f"/robot_{address}", "--addresses", str(address),
                           "--base-frame", "{address}/base_link", "--imu-frame", "{address}/imu_link")
              for address in (7, 8)]
    wait_for("both nodes are listed", lambda: set(names) <= set(ros2("node", "list").split()))
    wait_for("each has its beacon", lambda: {"/robot_7/hedge_7/odom", "/robot_8/hedge_8/odom"}
             <= set(ros2("topic", "list").split()))
    check("/robot_7/hedge_8/odom" not in ros2("topic", "list"), "and no other")
    wait_for("a relay resets its own beacon alone", lambda: "message='reset 8'" in ros2(
        "service", "call", names[1] + "/reset", "std_srvs/srv/Trigger"))
    relays[0].kill()
    wait_for("a killed relay disappears", lambda: names[0] not in ros2("node", "list").split())
    check(names[1] in ros2("node", "list").split(), "the other stays")


def launch(system):
    """GIVEN the package sonopose_ros2, built beside ROS 2 WHEN ros2 launch starts its launch file, with a file of
    parameters THEN bridge, fusion and relay run, the relay with these parameters, and they end with the launch."""
    package = os.path.join(SOURCE, "ros2", "sonopose_ros2")
    build, prefix = (os.path.join(system.folder.name, each) for each in ("build", "prefix"))
    environment = dict(os.environ, PATH=system.binaries + ":" + os.environ["PATH"])
    for command in (["cmake", "-S", package, "-B", build, "-DCMAKE_INSTALL_PREFIX=" + prefix,
                     "-DPython3_EXECUTABLE=/usr/bin/python3"], ["cmake", "--install", build]):
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        check(done.returncode == 0, f"cmake {command[1]} {done.stderr[-2000:]}")
    os.environ["AMENT_PREFIX_PATH"] = prefix + ":" + os.environ["AMENT_PREFIX_PATH"]
    parameters_file = os.path.join(system.folder.name, "robot.yaml")
    with open(parameters_file, "w", encoding="utf-8") as file:
        file.write("/robot/sonopose: {ros__parameters: {base_frame: chassis, mount: [0.1, 0.0, 0.0, 0.0, 0.0, 90.0]}}")
    launched = system.run(["ros2", "launch", "sonopose_ros2", "beacons.launch.py", "namespace:=robot",
                           "params:=" + parameters_file])
    wait_for("the relay runs with its parameters",
             lambda: "chassis" in ros2("param", "get", "/robot/sonopose", "base_frame"))
    check("90.0" in ros2("param", "get", "/robot/sonopose", "mount"), "also with lists")
    wait_for("it relays the simulated beacon", lambda: "child_frame_id: chassis" in ros2(
        "topic", "echo", "--once", "/robot/hedge_7/odom"))
    launched.send_signal(signal.SIGINT)
    check(launched.wait(LIMIT_S) == 0, "the launch ends cleanly")
    wait_for("so do the programs", lambda: "/robot/sonopose" not in ros2("node", "list").split())


def main():
    cases = {each.__name__: each for each in (topics, parameters, robots, transforms, bags, launch)}
    system = System(sys.argv[1])
    try:
        cases[sys.argv[2]](system)
    finally:
        system.end()


main()
