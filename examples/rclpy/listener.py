#!/usr/bin/env python3
"""A ROS 2 node that prints the position of the robot and the diagnostics of its beacon."""

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data


class Listener(Node):
    def __init__(self):
        super().__init__("sonopose_listener")
        # The relay writes reliably, so this best-effort profile matches, and so does the default one.
        self.create_subscription(Odometry, "/hedge_7/odom", self.on_odometry, qos_profile_sensor_data)
        self.create_subscription(DiagnosticArray, "/diagnostics", self.on_diagnostics, 10)

    def on_odometry(self, odometry):
        position = odometry.pose.pose.position
        self.get_logger().info(
            f"{odometry.child_frame_id} in {odometry.header.frame_id}: "
            f"{position.x:.3f} {position.y:.3f} {position.z:.3f}",
            throttle_duration_sec=0.5,
        )

    def on_diagnostics(self, diagnostics):
        for status in diagnostics.status:
            self.get_logger().info(f"{status.name}: {status.message}")


def main():
    rclpy.init()
    node = Listener()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
