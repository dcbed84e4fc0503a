/// A bus with DDS Security: members work, everybody else is refused, and the pose is not disturbed.

#include "doctor_run.hpp"
#include "secured_chain.hpp"
#include "security/authority.hpp"
#include "security/signed_document.hpp"
#include "standby_pair.hpp"
#include "support/wait_until.hpp"

#include <fmt/format.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <string>

namespace security_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;
namespace fs = std::filesystem;

SCENARIO("a secured chain serves its members alone") {
  SecuredChain chain;
  const std::size_t before = chain.tap.count();
  THEN("a process without a certificate sees and disturbs nothing, and the doctor names it") {
    {
      Process usurper(SONOPOSE_TEST_FUSION, chain.usurping({}), unsecured);
      REQUIRE(usurper.wait_for_line(Stream::error, "serving"));
      const Result stranger =
          run(SONOPOSE_TEST_MONITOR, chain.in_domain({"--duration", "1", "--json"}), unsecured);
      CHECK(stranger.code == 1);
      CHECK_THAT(stranger.output, !Contains("\"address\":7"));
      const std::string stranger_name = fmt::format("process {} on ", usurper.pid());
      const Result doctor = look_for(stranger_name, chain.bus.domain_id(), {"--duration", "3"});
      CAPTURE(doctor.output, doctor.error);
      CHECK(doctor.code == 1);
      CHECK_THAT(doctor.output,
                 Contains(stranger_name) && Contains("it has no certificate of this key store"));
      CHECK_THAT(doctor.output,
                 !Contains(fmt::format("refused sonopose-fusion (process {} on ", chain.fusion->pid())));
      chain.check_undisturbed(before);
    }
    AND_THEN("members of another key store are refused, with the reason in the log of one side") {
      {
        const KeyStoreOfRoles foreign;
        Process usurper(SONOPOSE_TEST_FUSION, chain.usurping(foreign.arguments("fusion")));
        const std::string reason = "its certificate is of another key store";
        CHECK(wait_until([&] {
          const std::string logs = usurper.text(Stream::error) + chain.bridge->text(Stream::error) +
                                   chain.fusion->text(Stream::error);
          return logs.find(reason) != std::string::npos;
        }));
        chain.check_undisturbed(before);
      }
      AND_THEN("a consumer can neither write poses nor change settings, an operator can") {
        const Result usurper = run(SONOPOSE_TEST_FUSION, chain.usurping({"--enclave", "consumer"}));
        CHECK(usurper.code == 78);
        CHECK_THAT(usurper.error, Contains("may not write sonopose/pose"));
        const Arguments change{"set", "admission.min_quality_percent=61"};
        Arguments as_consumer = change;
        as_consumer.insert(as_consumer.end(), {"--enclave", "consumer"});
        const Result refused = chain.bus.settings(as_consumer);
        CHECK(refused.code == 78);
        CHECK_THAT(refused.error, Contains("Not Allowed By Security"));
        const Result accepted = chain.bus.settings(change);
        CAPTURE(accepted.error);
        CHECK(accepted.code == 0);
        chain.check_undisturbed(before);
      }
    }
  }
}

SCENARIO("a sender to an autopilot joins a secured bus with its own role") {
  const KeyStoreOfRoles keys;
  const SecuredByEnvironment environment(keys.store);
  const Bus bus;
  Process sender(SONOPOSE_TEST_MAVLINK,
                 {"--udp", "127.0.0.1:14550", "--domain", std::to_string(bus.domain_id())});
  CHECK(sender.wait_for_line(Stream::error, "serving"));
  CHECK_THAT(sender.text(Stream::error), Contains("enclave autopilot"));
}

/// Copies the enclave of a consumer, to be forged.
fs::path copied_consumer(const KeyStoreOfRoles& keys, const std::string& name) {
  const fs::path forged = keys.store.enclave_folder(name);
  fs::copy(keys.store.enclave_folder("consumer"), forged);
  return forged;
}

/// Starts a process that writes poses with these files as the strongest of all, and checks that none arrives.
/// Waits until the bridge or the fusion logs `refusal`, if there is one. Returns what the process says.
std::string intrude(const SecuredChain& chain, const fs::path& enclave, const std::string& refusal = {}) {
  const std::size_t before = chain.tap.count();
  Process intruder(SONOPOSE_TEST_INTRUDER, {std::to_string(chain.bus.domain_id()), enclave.string()});
  REQUIRE(intruder.wait_for_lines(Stream::output, 1));
  CHECK(wait_until([&] {
    const std::string logs = chain.bridge->text(Stream::error) + chain.fusion->text(Stream::error);
    return logs.find(refusal) != std::string::npos;
  }));
  chain.check_undisturbed(before);
  return intruder.text(Stream::output);
}

SCENARIO("stolen and forged permissions are refused") {
  SecuredChain chain;
  WHEN("a consumer has the permissions of a fusion") {
    const fs::path forged = copied_consumer(chain.keys, "stolen");
    fs::copy(chain.keys.store.enclave_folder("fusion") / "permissions.p7s", forged / "permissions.p7s",
             fs::copy_options::overwrite_existing);
    CHECK_THAT(intrude(chain, forged), Contains("refused: ") && Contains("Subject name is invalid"));
    AND_WHEN("it has an authority of its own for its permissions and governance") {
      const fs::path of_its_own = copied_consumer(chain.keys, "of_its_own");
      const security::KeyPair own = security::make_permissions_authority("own", valid_for(1000));
      const security::Grant grant{.subject = "CN=/consumer",
                                  .validity = valid_for(1000),
                                  .access = {.writes = {"*"}, .reads = {"*"}},
                                  .partitions = {}};
      const std::map<std::string, std::string> files{
          {"permissions_ca.cert.pem", own.certificate_pem},
          {"permissions.p7s", security::signed_document(security::permissions_xml(grant), own)},
          {"governance.p7s",
           security::signed_document(security::governance_xml(security::Protection::sign), own)}};
      for (const auto& [name, text] : files) {
        fs::remove(of_its_own / name);
        write_text(of_its_own / name, text);
      }
      CHECK_THAT(intrude(chain, of_its_own, "not signed by our permissions authority"), Contains("writing"));
      AND_WHEN("a leaf under the permissions authority signs its permissions (CVE-2023-24011)") {
        const fs::path root = chain.keys.store.folder();
        const security::KeyPair authority{read_text(root / "public/permissions_ca.cert.pem"),
                                          read_text(root / "private/permissions_ca.key.pem")};
        const security::KeyPair leaf = security::issue(authority, "/consumer", valid_for(1000));
        const fs::path of_leaf = copied_consumer(chain.keys, "of_leaf");
        write_text(of_leaf / "permissions.p7s",
                   security::signed_document(security::permissions_xml(grant), leaf));
        CHECK_THAT(intrude(chain, of_leaf), Contains("refused: "));
      }
    }
  }
}

SCENARIO("a revoked certificate is refused by processes that start later") {
  const TemporaryFolder folder;
  const fs::path copy = folder / "stolen";
  fs::create_directory(copy);
  const SecuredChain chain([&copy](const KeyStoreOfRoles& keys) {
    for (const auto& entry : fs::directory_iterator(keys.store.enclave_folder("fusion"))) {
      if (entry.path().filename() != "crl.pem") fs::copy(entry.path(), copy);
    }
    keys.store.revoke("fusion", time_now_s());
    keys.add("fusion", "fusion", security::day_s);
  });
  CHECK_THAT(intrude(chain, copy, "its certificate is revoked"), Contains("writing"));
}

SCENARIO("secured processes return, and a standby takes over") {
  const KeyStoreOfRoles keys(security::Protection::encrypt);
  const SecuredByEnvironment environment(keys.store);
  WHEN("each is killed and started again") {
    const char* const number = std::getenv("SONOPOSE_KILLS");
    const int kills = number == nullptr ? 2 : std::atoi(number);
    const Bus bus;
    const PoseTap tap(bus);
    auto bridge = bus.bridge(rest);
    auto fusion = bus.fusion();
    REQUIRE_FALSE(tap.wait_for_count(0, 1).empty());
    double longest_s = 0;
    for (int i = 0; i < kills; ++i) {
      for (std::unique_ptr<Process>* const process : {&bridge, &fusion}) {
        (*process)->send(SIGKILL);
        REQUIRE((*process)->wait_for_exit() == -SIGKILL);
        const std::size_t before = tap.count();
        const SteadyTime started = clocks::steady_now();
        *process = process == &bridge ? bus.bridge(rest) : bus.fusion();
        const auto poses = tap.wait_for_count(before, 20);
        REQUIRE(poses.size() >= 20);
        longest_s = std::max(longest_s, seconds_between(started, poses[19].received));
      }
    }
    fmt::print("{} restarts: poses again within {:.2f} s\n", 2 * kills, longest_s);
  }
  WHEN("the stronger of two fusions is killed") {
    UnequalPair pair;
    pair.wait_until_served_by(pair.strong);
    const std::size_t before = pair.tap.count();
    const SteadyTime killed = clocks::steady_now();
    pair.strong.process->send(SIGKILL);
    const auto first = pair.tap.wait_for(
        [&](const TappedPose& tapped) { return tapped.pose.address == contested && pair.weak.wrote(tapped); },
        before);
    REQUIRE(first);
    fmt::print("taken over after {:.0f} ms\n", seconds_between(killed, first->received) * 1e3);
  }
}

}  // namespace security_test
