/// Programs that are given an enclave that does not fit, or variables of ROS 2 for none.

#include "support/secured_bus.hpp"
#include "support/temporary_folder.hpp"
#include "support/wait_until.hpp"
#include <sonopose/dds/psm/discovery.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>

namespace security_refusal_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
namespace fs = std::filesystem;

SCENARIO("an enclave that does not fit the program is a mistake of its configuration") {
  const KeyStoreOfRoles keys;
  keys.store.add("hall", {.roles = {"fusion"}, .partitions = {"hall-*"}, .validity = valid_for(10'000)});
  const auto refused = [&](const char* program, Arguments options, const std::string& option) {
    options.insert(options.begin(), {"--security", keys.store.folder().string()});
    const Result result = run(program, options);
    CAPTURE(options, result.error);
    CHECK(result.code == 78);
    CHECK_THAT(result.error, Contains(option));
    return result.error;
  };
  THEN("a fusion and a bridge name the option and what they need, before they join and when only checked") {
    for (const char* const check : {"--check-config", "--domain=7"}) {
      CHECK_THAT(refused(SONOPOSE_TEST_FUSION, {"--enclave", "monitor", check}, "--enclave"),
                 Contains("may not write sonopose/pose") && Contains("role fusion"));
      refused(SONOPOSE_TEST_FUSION, {"--partition", "room", check}, "--partition room: ");
      CHECK_THAT(refused(SONOPOSE_TEST_FUSION, {"--enclave", "hall", "--partition", "room", check},
                         "--partition room: "),
                 Contains("only hall-*"));
      CHECK_THAT(refused(SONOPOSE_TEST_FUSION, {"--enclave", "hall", check}, "--partition"),
                 Contains("only hall-*"));
      refused(SONOPOSE_TEST_FUSION, {"--enclave", "../enclaves/fusion", check}, "--enclave: '../enclaves");
    }
    refused(SONOPOSE_TEST_FUSION, {"--domain", "231", "--check-config"}, "--domain 231: ");
    refused(SONOPOSE_TEST_BRIDGE, {"--enclave", "fusion", "--scenario", "rest"},
            "may not write sonopose/imu");
    refused(SONOPOSE_TEST_MONITOR, {"--enclave", "bridge"}, "sonopose/pose");
    CHECK_THAT(run(SONOPOSE_TEST_FUSION, {"--security", "", "--check-config"}).error,
               Contains("--security: the path is empty"));
  }
  THEN("one that fits passes the check") {
    CHECK(run(SONOPOSE_TEST_FUSION, {"--security", keys.store.folder().string(), "--enclave", "hall",
                                     "--partition", "hall-2", "--domain", "230", "--check-config"})
              .code == 0);
  }
  THEN("an option of a file is named with file and line") {
    const TemporaryFolder folder;
    const fs::path file = folder / "fusion.toml";
    write_text(file,
               "[program]\nsecurity = \"" + keys.store.folder().string() + "\"\nenclave = \"monitor\"\n");
    const Result result = run(SONOPOSE_TEST_FUSION, {"--config", file.string(), "--check-config"});
    CHECK(result.code == 78);
    CHECK_THAT(result.error, Contains(file.string() + ":3: program.enclave: "));
  }
}

SCENARIO("ROS 2's variables secure a program, or it says why not") {
  const KeyStoreOfRoles keys;
  const auto checked = [&](const std::string& enable, const std::string& strategy,
                           const std::string& override) {
    return run(SONOPOSE_TEST_FUSION, {"--check-config"},
               {{"ROS_SECURITY_KEYSTORE", keys.store.folder().string()},
                {"ROS_SECURITY_ENABLE", enable},
                {"ROS_SECURITY_STRATEGY", strategy},
                {"ROS_SECURITY_ENCLAVE_OVERRIDE", override}});
  };
  THEN("true may have any case") {
    CHECK(checked("True", "Enforce", "").code == 0);
    CHECK_THAT(checked("TRUE", "Enforce", "/nosuch").error, Contains("nosuch: no such enclave"));
    CHECK(checked("False", "Enforce", "/nosuch").code == 0);
  }
  THEN("another word is refused, since it would leave the program without security") {
    const Result result = checked("1", "Enforce", "");
    CHECK(result.code == 78);
    CHECK_THAT(result.error, Contains("ROS_SECURITY_ENABLE is '1': must be true or false"));
  }
  THEN("Permissive names the enclave that is missing") {
    const Result result = checked("true", "Permissive", "/nosuch");
    CHECK(result.code == 0);
    CHECK_THAT(result.error, Contains("no enclave nosuch, so this program joins without security") &&
                                 !Contains("no enclave fusion"));
  }
}

SCENARIO("a secured process is known by its name") {
  const KeyStoreOfRoles keys;
  const SecuredByEnvironment environment(keys.store);
  const Bus bus;
  const auto fusion = bus.fusion();
  const sonopose::dds::Discovery discovery(sonopose::dds::ext::participant({.domain_id = bus.domain_id()}));
  CHECK(wait_until([&] {
    const auto all = discovery.participants();
    return std::ranges::any_of(all, [&](const sonopose::dds::FoundParticipant& each) {
      return each.process_name == "sonopose-fusion" &&
             each.process_id == static_cast<std::uint32_t>(fusion->pid()) && !each.host_name.empty();
    });
  }));
}

}  // namespace security_refusal_test
