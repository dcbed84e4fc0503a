"""Starts sonopose for ROS 2: the bridge, the fusion and the relay, which is the node /sonopose.

ros2 launch ./sonopose.launch.py source:=serial device:=/dev/ttyACM0
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression


def generate_launch_description():
    source = LaunchConfiguration("source")
    from_line = PythonExpression(["'", source, "' == 'serial'"])
    otherwise = PythonExpression(["'", source, "' != 'serial'"])

    def program(name, *arguments, condition=None):
        # The programs exit cleanly on SIGINT, which launch sends first.
        return ExecuteProcess(
            cmd=[f"sonopose-{name}", *arguments], name=name, output="screen", condition=condition
        )

    return LaunchDescription(
        [
            DeclareLaunchArgument("source", default_value="sim", description="sim, or serial: a beacon on USB"),
            DeclareLaunchArgument("device", default_value="/dev/ttyACM0", description="The beacon's serial line"),
            DeclareLaunchArgument("tf", default_value="map_base", description="map_base, map_odom or off"),
            DeclareLaunchArgument("path", default_value="30", description="Length of /hedge_7/path in seconds"),
            program("fusion"),
            program("ros2", "--tf", LaunchConfiguration("tf"), "--path", LaunchConfiguration("path")),
            program(
                "bridge",
                "--source",
                "serial",
                "--device",
                LaunchConfiguration("device"),
                condition=IfCondition(from_line),
            ),
            program("bridge", "--source", source, condition=IfCondition(otherwise)),
        ]
    )
