#include "dds/binding/announced_process.hpp"

#include <catch2/catch.hpp>

#include <cstddef>
#include <memory>
#include <string>

namespace announced_process_test {

/// Returns the user data of a participant, which had these before its process was announced.
std::string announced(const std::string& user_data) {
  const std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)> qos(dds_create_qos(), dds_delete_qos);
  if (!user_data.empty()) dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  sonopose::dds::announce_process(qos.get());
  void* bytes = nullptr;
  std::size_t size = 0;
  REQUIRE(dds_qget_userdata(qos.get(), &bytes, &size));
  const std::unique_ptr<void, decltype(&dds_free)> owner(bytes, dds_free);
  return {static_cast<const char*>(bytes), size};
}

TEST_CASE("A secured participant names its process, but leaves user data of an application alone") {
  const std::string process = "process=test_dds";
  CHECK(announced("").starts_with(process));
  CHECK(announced("enclave=/x;").starts_with("enclave=/x;" + process));  // a node of ROS 2
  for (const std::string& own : {std::string("\0\xff\7", 3), std::string("name=arm;")}) {
    CHECK(announced(own) == own);
  }
}

}  // namespace announced_process_test
