#include <sonopose/ros2/type_hash.hpp>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace sonopose::ros2 {
namespace {

struct Row {
  std::string_view type;
  std::string_view hash;
};

constexpr std::array hashes{
    Row{"sensor_msgs::msg::dds_::Imu_", "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
    Row{"nav_msgs::msg::dds_::Odometry_", "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
    Row{"rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
        "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"},
};

}  // namespace

std::string type_hash(const std::string& dds_type_name) {
  const auto row =
      std::find_if(hashes.begin(), hashes.end(), [&](const Row& each) { return each.type == dds_type_name; });
  return "RIHS01_" + (row == hashes.end() ? std::string(64, '0') : std::string(row->hash));
}

}  // namespace sonopose::ros2
