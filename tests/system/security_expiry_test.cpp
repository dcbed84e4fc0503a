/// Certificates on a secured bus that expire, and commands on key stores.

#include "recorded_part.hpp"
#include "secured_chain.hpp"
#ifdef SONOPOSE_TEST_WEB
#include "web_process.hpp"
#endif

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <memory>
#include <string>

namespace security_expiry_test {

using namespace sonopose;
using namespace sonopose::test;
using Catch::Contains;

SCENARIO("a certificate that expires") {
  SecuredChain chain;
  WHEN("it has expired before the start") {
    chain.keys.add("late", "monitor", -10);
    const Result result = run(SONOPOSE_TEST_MONITOR, chain.in_domain({"--enclave", "late"}));
    THEN("the program names file and verb, and a service does not try again") {
      CHECK(result.code == 78);
      CHECK_THAT(result.error, Contains("late/cert.pem: expired on") && Contains("sonopose-security renew"));
    }
  }
  WHEN("it expires while a program and a consumer run") {
    std::unique_ptr<Process> monitor;
    std::unique_ptr<Process> reader;
    std::chrono::seconds life(4);
    do {  // longer on a machine that is too busy for both to begin in time
      life *= 2;
      REQUIRE(life < std::chrono::seconds(300));
      const std::string suffix = std::to_string(life.count());
      chain.keys.add("brief" + suffix, "monitor", life.count());
      chain.keys.add("short" + suffix, "consumer", life.count());
      monitor = std::make_unique<Process>(SONOPOSE_TEST_MONITOR,
                                          chain.in_domain({"--json", "--enclave", "brief" + suffix}));
      reader = std::make_unique<Process>(SONOPOSE_TEST_INTRUDER,
                                         Arguments{std::to_string(chain.bus.domain_id()),
                                                   chain.keys.store.enclave_folder("short" + suffix).string(),
                                                   std::to_string(time_now_s() + life.count())});
    } while (!reader->wait_for_line(Stream::output, "receives poses", life) ||
             !monitor->wait_for_line(Stream::error, "expires within a day", life));
    THEN("the program warns, and ends with the reason; the consumer loses its poses; the others go on") {
      CHECK(monitor->wait_for_exit() == 78);
      CHECK_THAT(monitor->text(Stream::error), Contains("expired on") && Contains("renew"));
      CHECK(reader->wait_for_line(Stream::output, "receives no poses"));
      chain.check_undisturbed(chain.tap.count());
    }
  }
}

SCENARIO("an expiry within 30 days shows in doctor, metrics and log") {
  SecuredChain chain;
  constexpr std::int64_t left_s = 12 * security::day_s + 3600;
  chain.keys.add("brief", "monitor", left_s);
  THEN("the doctor names the enclave, also of another process, and the page has its date") {
    const Result doctor = run(SONOPOSE_TEST_DOCTOR, chain.in_domain({"--duration", "1"}));
    CAPTURE(doctor.output);
    CHECK(doctor.code == 1);
    CHECK_THAT(doctor.output, Contains("enclave brief expires in 12 days, at ") &&
                                  Contains("sonopose-security renew") && !Contains("enclave fusion expires"));
    const Result monitor =
        run(SONOPOSE_TEST_MONITOR, chain.in_domain({"--enclave", "brief", "--duration", "1", "--json"}));
    CHECK_THAT(monitor.error, Contains("enclave brief expires in 12 days") && Contains("renew"));
#ifdef SONOPOSE_TEST_WEB
    const Web web(chain.bus, {"--listen", "127.0.0.1:0"});
    const std::string metrics = web.get("/metrics");
    const std::string name = R"(sonopose_enclave_expiry_seconds{enclave="brief"} )";
    CAPTURE(metrics);
    REQUIRE_THAT(metrics,
                 Contains(name) && Contains(R"(sonopose_enclave_expiry_seconds{enclave="fusion"} )"));
    const std::int64_t expires_s = std::stoll(metrics.substr(metrics.find(name) + name.size()));
    CHECK(expires_s <= time_now_s() + left_s);
    CHECK(expires_s > time_now_s() + left_s - 600);
#endif
  }
}

SCENARIO("sonopose-security lists and renews enclaves") {
  const KeyStoreOfRoles keys;
  const std::string store = keys.store.folder().string();
  keys.add("late", "monitor", -10);
  keys.add("brief", "operator", 2 * security::day_s);
  const auto command = [&store](const std::string& verb, Arguments names) {
    names.insert(names.begin(), {verb, store});
    return run(SONOPOSE_TEST_SECURITY, names);
  };
  // The date may change before a program reads the clock.
  const auto shows = [start_s = time_now_s()](const Result& result, const std::string& name,
                                              std::int64_t days) {
    return std::ranges::any_of(std::array{start_s, time_now_s()}, [&](std::int64_t now_s) {
      return result.output.find(name + ": until " + security::date_text(now_s + days * security::day_s)) !=
             std::string::npos;
    });
  };
  THEN("the list says what each may do and until when, and goes on after one that cannot be used") {
    const Result list = command("list", {});
    CHECK(list.code == 1);
    CAPTURE(list.output);
    CHECK(shows(list, "brief", 2));
    CHECK_THAT(list.output,
               Contains("; writes sonopose/reset, sonopose/settings_request; reads sonopose/* (sign)") &&
                   Contains("late: unusable: ") && Contains("expired on ") && Contains("web: until "));
  }
  THEN("a renewed enclave works again, for as long as before or as said, and the others are as they were") {
    const std::string other = read_text(keys.store.enclave_folder("web") / "cert.pem");
    const Result brief = command("renew", {"brief"});
    CHECK(brief.code == 0);
    CAPTURE(brief.output);
    CHECK(shows(brief, "brief", 2));
    CHECK(command("renew", {"late", "--days", "40"}).code == 0);
    CHECK(read_text(keys.store.enclave_folder("web") / "cert.pem") == other);
    const Result list = command("list", {});
    CHECK(list.code == 0);
    CAPTURE(list.output);
    CHECK(shows(list, "late", 40));
    const Result check = command("check", {});
    CHECK(check.code == 1);  // brief expires within 30 days
    CHECK_THAT(check.output, Contains("brief: expires in ") && !Contains("late"));
  }
  THEN("a changed protection stays until another is asked for, and is named") {
    CHECK_THAT(command("governance", {"--protect", "encrypt"}).output, Contains("sign → encrypt"));
    CHECK_THAT(command("governance", {}).output, Contains("encrypt → encrypt"));
    CHECK_THAT(command("list", {}).output, Contains("(encrypt)") && !Contains("(sign)"));
  }
  THEN("no success is reported for what was not repaired") {
    write_text(keys.store.folder() / "enclaves/governance.p7s", "garbage");
    const Result renewed = command("renew", {"web"});
    CHECK(renewed.code == 1);
    CHECK_THAT(renewed.error,
               Contains("governance.p7s") && Contains("sonopose-security governance " + store));
    CHECK_THAT(renewed.output, !Contains("until"));
    CHECK(command("governance", {}).code == 0);
    CHECK(command("renew", {"web"}).code == 0);
  }
  THEN("one that does not exist is named, with exit code 1") {
    const Result result = command("renew", {"none"});
    CHECK(result.code == 1);
    CHECK_THAT(result.error, Contains("enclaves/none: no such enclave"));
  }
}

SCENARIO("a bridge's enclave plays its own topics, and names those of a recording that it may not write") {
  const TemporaryFolder folder;
  const std::string file = (folder / "run.mcap").string();
  const SecuredChain chain;
  auto recorder = chain.bus.record({file, "--topics", "sonopose/imu,sonopose/fix,sonopose/pose"});
  REQUIRE(recorder->wait_for_line(Stream::error, "enclave recorder"));
  REQUIRE(wait_for_part(file, {"sonopose/fix"}, 10));
  REQUIRE(wait_for_part(file, {"sonopose/pose"}, 100));
  REQUIRE(recorder->end_by(SIGINT).code == 0);
  const Result all = run(SONOPOSE_TEST_PLAY, chain.in_domain({file, "--no-wait"}));
  CHECK(all.code.value_or(0) > 0);
  CHECK_THAT(all.error, Contains("the enclave may not write sonopose/pose") && Contains("--topics"));
  const std::size_t before = chain.tap.count();
  const Result own =
      run(SONOPOSE_TEST_PLAY, chain.in_domain({file, "--no-wait", "--rate", "10", "--topics", "fix"}));
  CAPTURE(own.error);
  CHECK(own.code == 0);
  chain.check_undisturbed(before);
}

}  // namespace security_expiry_test
