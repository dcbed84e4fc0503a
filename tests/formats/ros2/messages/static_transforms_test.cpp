#include <sonopose/ros2/messages/messages.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>

#include <catch2/catch.hpp>

#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

namespace static_transforms_test {

using namespace sonopose;
using namespace sonopose::ros2;

const std::string base = "base_link";
const std::string plate = "plate";
const std::string imu = "imu_link";
const Quaterniond quarter_left(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()));

bool add(StaticTransforms& tree, std::vector<TransformStamped> transforms) {
  const auto length = static_cast<std::uint32_t>(transforms.size());
  return tree.add({{length, length, transforms.data(), false}});
}

SCENARIO("the mount of the IMU is found over the frames between") {
  GIVEN("a plate that is turned to the left and 1 m in front, and an IMU 0.5 m in front on the plate") {
    StaticTransforms tree;
    add(tree, {ros2::transform({{1, 0, 0}, quarter_left}, 0, base, plate),
               ros2::transform({{0.5, 0, 0.1}, Quaterniond::Identity()}, 0, plate, imu)});
    THEN("the IMU is 0.5 m to the left of the plate's place") {
      const auto found = tree.find(base, imu);
      REQUIRE(found);
      CHECK((found->translation_m - Vector3d(1, 0.5, 0.1)).norm() < 1e-12);
      CHECK(found->rotation.angularDistance(quarter_left) < 1e-7);
    }
    THEN("the same transform again, with the slash of old drivers, moves nothing") {
      add(tree, {ros2::transform({{0.5, 0, 0.1}, Quaterniond::Identity()}, 0, "/" + plate, "/" + imu)});
      CHECK((tree.find(base, imu)->translation_m - Vector3d(1, 0.5, 0.1)).norm() < 1e-12);
      CHECK(tree.moved().empty());
    }
    THEN("frames that are not connected, and the opposite direction, give nothing") {
      CHECK_FALSE(tree.find("map", imu));
      CHECK_FALSE(tree.find(imu, base));
      CHECK_FALSE(StaticTransforms().find(base, imu));
    }
    THEN("frames of one tree are found in each other, in whatever direction") {
      add(tree, {ros2::transform({{0, 0, 2}, Quaterniond::Identity()}, 0, base, "tag")});
      const auto tag = tree.between(plate, "tag");
      REQUIRE(tag);
      CHECK((tag->translation_m - Vector3d(0, 1, 2)).norm() < 1e-12);
      CHECK(tree.between(base, base)->translation_m.isZero(0));
      CHECK((tree.between(imu, base)->translation_m - Vector3d(-0.5, 1, -0.1)).norm() < 1e-12);
      CHECK_FALSE(tree.between("map", imu));
    }
    WHEN("a later message moves the IMU, and others are invalid") {
      const double nan = std::numeric_limits<double>::quiet_NaN();
      add(tree, {ros2::transform({{0.7, 0, 0}, Quaterniond::Identity()}, 0, plate, imu)});
      add(tree, {ros2::transform({{nan, 0, 0}, Quaterniond::Identity()}, 0, plate, imu)});
      add(tree, {ros2::transform({{9, 0, 0}, Quaterniond(0, 0, 0, 0)}, 0, plate, imu)});
      THEN("the latest valid one counts, and is known to have moved") {
        CHECK((tree.find(base, imu)->translation_m - Vector3d(1, 0.7, 0)).norm() < 1e-12);
        CHECK(tree.moved() == std::set<std::string>{imu});
      }
    }
  }
  GIVEN("more frames than there may be, and then one with a long name") {
    StaticTransforms tree;
    for (std::size_t i = 0; i < StaticTransforms::max_frames; ++i) {
      const std::string child = "frame_" + std::to_string(i);
      REQUIRE(add(tree, {ros2::transform({{1, 0, 0}, Quaterniond::Identity()}, 0, base, child)}));
    }
    THEN("a new one is refused, and a known one can change") {
      CHECK_FALSE(add(tree, {ros2::transform({}, 0, base, imu)}));
      CHECK_FALSE(tree.find(base, imu));
      CHECK(add(tree, {ros2::transform({{2, 0, 0}, Quaterniond::Identity()}, 0, base, "frame_7")}));
      CHECK(tree.find(base, "frame_7")->translation_m.x() == 2);
    }
    THEN("a long name is refused") {
      const std::string name(StaticTransforms::max_name_length + 1, 'x');
      StaticTransforms other;
      CHECK_FALSE(add(other, {ros2::transform({}, 0, base, name)}));
      CHECK_FALSE(add(other, {ros2::transform({}, 0, name, base)}));
    }
  }
  GIVEN("transforms in a circle") {
    StaticTransforms tree;
    add(tree, {ros2::transform({}, 0, plate, imu), ros2::transform({}, 0, imu, plate)});
    THEN("the search ends") {
      CHECK_FALSE(tree.find(base, imu));
    }
  }
}

}  // namespace static_transforms_test
