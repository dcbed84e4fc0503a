/// The place that our function takes in Cyclone DDS. A wait of 100 s and a second handshake, which end a
/// process without it, are too long for a test.

#include "clocks/clocks.hpp"
#include "dds/binding/security.hpp"
#include "dds/dds_fixture.hpp"
#include "security/key_store.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <dds/version.h>

#include <cstdio>
#include <memory>
#include <string>

namespace sonopose::dds::test::handshake_limit_test {

#if DDS_VERSION_MAJOR == 0
SCENARIO("Handshakes have no limit of time, at which Cyclone DDS 0.10 would use freed memory") {
  GIVEN("a key store, and a writer of poses with an enclave of it") {
    const sonopose::test::TemporaryFolder folder;
    const std::int64_t now_s = clocks::host_now() / 1'000'000'000;
    const auto keys = security::KeyStore::create(folder / "keys", security::Protection::sign, now_s);
    const security::Validity valid{now_s - security::day_s, now_s + security::day_s};
    keys.add("fusion", {.roles = {"fusion"}, .validity = valid});
    keys.add("consumer", {.roles = {"consumer"}, .validity = valid});
    const domain::DomainParticipant secured = ext::participant(
        {.domain_id = test_domain(), .enclave_folder = keys.enclave_folder("fusion").string()});
    auto writer = topics::make_writer(secured, project_qos(), topics::pose);
    WHEN("a reader of another process matches it after their handshake") {
      const Environment store("ROS_SECURITY_KEYSTORE", keys.folder().c_str());
      const Environment enable("ROS_SECURITY_ENABLE", "true");
      const Environment enclave("ROS_SECURITY_ENCLAVE_OVERRIDE", "consumer");
      const std::string command =
          std::string(SONOPOSE_TEST_DDS_PEER) + " " + std::to_string(test_domain()) + " loopback poses";
      const auto close = [](FILE* file) { pclose(file); };
      const std::unique_ptr<FILE, decltype(close)> peer(popen(command.c_str(), "w"), close);
      REQUIRE(peer != nullptr);
      REQUIRE(wait_for(writer, core::status::StatusMask::publication_matched(),
                       [&] { return writer.publication_matched_status().current_count() == 1; }));
      THEN("Cyclone DDS asked us for the limit") {
        CHECK(unlimited_handshakes() > 0);
      }
    }
  }
}
#endif

}  // namespace sonopose::dds::test::handshake_limit_test
