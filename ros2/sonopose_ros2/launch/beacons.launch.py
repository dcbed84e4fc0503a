"""Starts sonopose: the bridge, the fusion and the relay, which is the node /sonopose.

ros2 launch sonopose_ros2 beacons.launch.py source:=serial device:=/dev/serial/by-id/NAME
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackagePrefix, FindPackageShare

PACKAGE = "sonopose_ros2"


def program(name, *arguments, condition=None):
    """A program that is no ROS 2 node. It exits cleanly on SIGINT, which launch sends first."""
    path = PathJoinSubstitution([FindPackagePrefix(PACKAGE), "lib", PACKAGE, name])
    return ExecuteProcess(cmd=[path, *arguments], name=name, output="screen", condition=condition)


def generate_launch_description():
    source = LaunchConfiguration("source")
    from_line = PythonExpression(["'", source, "' == 'serial'"])
    otherwise = PythonExpression(["'", source, "' != 'serial'"])
    defaults = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "relay.yaml"])
    tf = ParameterValue(LaunchConfiguration("tf"), value_type=str)  # YAML reads off as false
    line = ["--source", "serial", "--device", LaunchConfiguration("device")]
    return LaunchDescription(
        [
            DeclareLaunchArgument("source", default_value="sim", description="sim, or serial: a beacon on USB"),
            DeclareLaunchArgument(  # required with serial: the name of a port depends on the order of plugging in
                "device", condition=IfCondition(from_line), description="The beacon's port: /dev/serial/by-id/…"
            ),
            DeclareLaunchArgument("params", default_value=defaults, description="Parameter file of the relay"),
            DeclareLaunchArgument("tf", default_value="map_base", description="map_base, map_odom or off"),
            DeclareLaunchArgument("namespace", default_value="", description="Namespace of the node"),
            program("sonopose-fusion"),
            program("sonopose-bridge", *line, condition=IfCondition(from_line)),
            program("sonopose-bridge", "--source", source, condition=IfCondition(otherwise)),
            Node(
                package=PACKAGE,
                executable="sonopose-ros2",
                name="sonopose",
                namespace=LaunchConfiguration("namespace"),
                output="screen",
                parameters=[LaunchConfiguration("params"), {"tf": tf}],
            ),
        ]
    )
