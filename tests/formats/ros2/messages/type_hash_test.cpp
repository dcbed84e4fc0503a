#include <sonopose/ros2/messages/idl_types.hpp>
#include <sonopose/ros2/messages/service_types.hpp>
#include <sonopose/ros2/messages/type_hash.hpp>

#include <catch2/catch.hpp>

#include <stdexcept>
#include <string>

namespace type_hash_test {

using namespace sonopose::ros2;

template <class T>
std::string hash_of() {
  return type_hash(sonopose::dds::TopicTraits<T>::descriptor().m_typename);
}

TEST_CASE("Types have the hashes that ROS 2 publishes") {
  // From ROS 2, share/<package>/msg/<type>.json.
  CHECK(hash_of<Imu>() == "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b");
  CHECK(hash_of<Odometry>() == "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0");
  CHECK(hash_of<JointState>() == "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e");
  CHECK(hash_of<Float64>() == "RIHS01_705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a");
  CHECK(hash_of<PoseWithCovarianceStamped>() ==
        "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e");
  CHECK(hash_of<TFMessage>() == "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
  CHECK(hash_of<DiagnosticArray>() ==
        "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e");
  CHECK(hash_of<MagneticField>() ==
        "RIHS01_e80f32f56a20486c9923008fc1a1db07bbb273cbbf6a5b3bfa00835ee00e4dff");
  CHECK(hash_of<Clock>() == "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564");
  CHECK(hash_of<ParticipantEntitiesInfo>() ==
        "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e");
  CHECK(hash_of<ParameterEvent>() ==
        "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204");
  CHECK(hash_of<LogMessage>() == "RIHS01_e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac");
}

TEST_CASE("A type that is not in idl/ros2 is rejected by name") {
  CHECK_THROWS_AS(type_hash("sensor_msgs::msg::dds_::Imu"), std::invalid_argument);
  CHECK_THROWS_WITH(type_hash("a::b"), Catch::Contains("'a::b'"));
}

}  // namespace type_hash_test
