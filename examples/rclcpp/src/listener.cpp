// A ROS 2 node that prints the position of the robot.

#include <memory>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>

class Listener : public rclcpp::Node {
public:
  Listener() : Node("sonopose_listener") {
    // The relay writes reliably, so this best-effort profile matches, and so does the default one.
    subscription_ = create_subscription<nav_msgs::msg::Odometry>(
        "/hedge_7/odom", rclcpp::SensorDataQoS(),
        [this](const nav_msgs::msg::Odometry& odometry) { on_odometry(odometry); });
  }

private:
  void on_odometry(const nav_msgs::msg::Odometry& odometry) {
    const auto& position = odometry.pose.pose.position;
    RCLCPP_INFO_THROTTLE(get_logger(), *get_clock(), 500, "%s in %s: %.3f %.3f %.3f",
                         odometry.child_frame_id.c_str(), odometry.header.frame_id.c_str(), position.x,
                         position.y, position.z);
  }

  rclcpp::Subscription<nav_msgs::msg::Odometry>::SharedPtr subscription_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Listener>());
  rclcpp::shutdown();
}
