#include "security/key_store.hpp"

#include "files/input_file.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/new_store.hpp"
#include "security/revocation.hpp"
#include "security/roles.hpp"
#include "support/temporary_folder.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>

#include <catch2/catch.hpp>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace key_store_test {

using namespace sonopose::security;
using namespace sonopose::security::test;
using namespace sonopose::test;
using Catch::Contains;
namespace fs = std::filesystem;
namespace files = sonopose::files;

SCENARIO("A new enclave has the files of SROS2") {
  const Store store;
  store.add("bridge", {"bridge"});
  const fs::path enclave = store.keys.enclave_folder("bridge");
  for (const char* const file : {"cert.pem", "key.pem", "identity_ca.cert.pem", "permissions_ca.cert.pem",
                                 "governance.p7s", "permissions.p7s", "permissions.xml"}) {
    CAPTURE(file);
    CHECK(fs::exists(enclave / file));
  }
  CHECK(fs::exists(store.keys.folder() / "enclaves/governance.xml"));
  THEN("only their owner can read the private keys") {
    for (const fs::path& key : {enclave / "key.pem", store.keys.folder() / "private/identity_ca.key.pem",
                                store.keys.folder() / "private/permissions_ca.key.pem"}) {
      CAPTURE(key);
      CHECK(fs::status(key).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
    }
  }
  THEN("it is in order, and expires with its certificate") {
    CHECK(store.problems().empty());
    CHECK(store.read("bridge").subject == "CN=/bridge");
    CHECK(store.read("bridge").expires_s == year.not_after_s);
    CHECK(store.read("bridge").protection == "sign");
    CHECK(store.keys.enclaves() == std::vector<std::string>{"bridge"});
  }
  THEN("30 days before, it is a problem that names the verb") {
    const auto problems = store.problems(year.not_after_s - 29 * day_s);
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems.front().text, Contains("expires in 29 days") && Contains("sonopose-security renew"));
    CHECK(store.problems(year.not_after_s - 32 * day_s).empty());
  }
  THEN("it is not made twice, and a key store not in a folder that has files") {
    CHECK_THROWS_WITH(store.add("bridge", {"bridge"}), Contains("renew"));
    CHECK_THROWS_AS(KeyStore::create(store.keys.folder(), Protection::sign, now_s), SecurityError);
  }
}

SCENARIO("Roles have the least privilege") {
  const auto writes = [](const char* role) {
    const Access access = access_of({role});
    return std::set<std::string>(access.writes.begin(), access.writes.end());
  };
  THEN("consumers, monitors, pages and recorders write nothing") {
    for (const char* const role : {"consumer", "monitor", "web", "recorder"}) CHECK(writes(role).empty());
  }
  THEN("the programs for autopilots read poses, and write their log alone") {
    const std::string role(role_of_program("mavlink"));
    CHECK(writes(role.c_str()) == std::set<std::string>{"sonopose/log"});
    CHECK(access_of({role}).reads == std::vector<std::string>{"sonopose/pose"});
  }
  THEN("only a fusion writes poses, only a bridge samples, only operator and relay ask for settings") {
    for (const char* const role : role_names) {
      CAPTURE(role);
      const std::string name = role;
      CHECK(writes(role).contains("sonopose/pose") == (name == "fusion"));
      CHECK(writes(role).contains("sonopose/imu") == (name == "bridge"));
      // The services of the relay change settings and reset.
      CHECK(writes(role).contains("sonopose/settings_request") == (name == "operator" || name == "ros2"));
      CHECK(writes(role).contains("sonopose/reset") == (name == "operator" || name == "ros2"));
      CHECK_FALSE(writes(role).contains("*"));
    }
  }
  THEN("they name the topics of topics.hpp, of which each has a writer") {
    std::set<std::string> topics;
    for (const auto& topic : sonopose::dds::topics::serialized_topics()) topics.emplace(topic.name);
    std::set<std::string> written;
    for (const char* const role : role_names) {
      written.merge(writes(role));
      for (const std::string& topic : access_of({role}).reads) {
        if (topic.starts_with("sonopose/") && !topic.ends_with('*')) CHECK(topics.contains(topic));
      }
    }
    std::erase_if(written, [](const std::string& topic) { return !topic.starts_with("sonopose/"); });
    CHECK(written == topics);
  }
  THEN("two roles have the rights of both") {
    CHECK(access_of({"bridge", "fusion"}).writes.size() == 16);  // 9 and 8, the log is common
    CHECK_THROWS_WITH(access_of({"pilot"}), Contains("pilot") && Contains("consumer"));
  }
}

SCENARIO("Permissions read back as they were written") {
  const Grant grant{
      .subject = "CN=/x", .validity = year, .access = access_of({"fusion"}), .partitions = {"hall-*"}};
  const Grant read = grant_of(permissions_xml(grant), "permissions.xml");
  CHECK(read.subject == grant.subject);
  CHECK(read.access.writes == grant.access.writes);
  CHECK(read.access.reads == grant.access.reads);
  CHECK(read.partitions == grant.partitions);
  CHECK(read.validity.not_after_s == year.not_after_s);
  CHECK_THAT(words_of(read), Contains("writes sonopose/") && Contains("in partitions hall-*"));
  const auto refusal = [&](const std::string& before, const std::string& added, const std::string& why) {
    std::string text = permissions_xml(grant);
    text.insert(text.find(before), added);
    CHECK_THROWS_WITH(grant_of(text, "permissions.xml"), Contains("permissions.xml") && Contains(why));
  };
  refusal("<allow_rule>", "<deny_rule/>", "deny_rule");
  refusal("<publish>", "<relay/>", "relay");
  refusal("<topics>", "<data_tags/>", "data_tags");
  refusal("</permissions>", "<grant/>", "several grants");
  refusal("</topic>", "<topic/>", "topics: 'topic' has more than a text");
  std::string mixed = permissions_xml(grant);
  const std::size_t first = mixed.find("<partitions>");
  mixed.erase(first, mixed.find("</partitions>", first) + std::string("</partitions>").size() - first);
  CHECK(grant_of(mixed, "permissions.xml").partitions == std::vector<std::string>{"hall-*", ""});
  CHECK_THROWS_WITH(grant_of("<dds/>", "permissions.xml"), Contains("permissions.xml"));
  CHECK_THROWS_WITH(grant_of("text", "permissions.xml"), Contains("permissions.xml"));
  CHECK(protection_in(governance_xml(Protection::encrypt), "governance.xml") == "encrypt");
}

SCENARIO("An unusable enclave is refused with the file and the verb that repairs it") {
  const Store store;
  store.add("fusion", {"fusion"});
  store.add("consumer", {"consumer"});
  const fs::path enclave = store.keys.enclave_folder("fusion");
  const fs::path other = store.keys.enclave_folder("consumer");
  const auto refusal = [&](const std::string& file, const std::string& why, std::int64_t at_s = now_s) {
    CHECK_THROWS_WITH(store.read("fusion", at_s), Contains((enclave / file).string()) && Contains(why));
    CHECK(store.problems(at_s).size() >= 1);
  };
  WHEN("a file is missing") {
    const std::string file = GENERATE("cert.pem", "key.pem", "governance.p7s", "permissions.p7s",
                                      "identity_ca.cert.pem", "permissions_ca.cert.pem");
    fs::remove(enclave / file);
    refusal(file, "sonopose-security renew " + store.keys.folder().string() + " fusion");
    THEN("that verb repairs it") {
      store.keys.renew("fusion", year);
      CHECK(store.problems().empty());
    }
  }
  WHEN("a file is garbage") {
    const std::string file = GENERATE("cert.pem", "key.pem", "permissions.p7s", "crl.pem");
    const std::string garbage = GENERATE("", "garbage", "-----BEGIN CERTIFICATE-----\nnone");
    const fs::path shared = store.keys.folder() / "public/crl.pem";
    write_text(file == "crl.pem" ? shared : enclave / file, garbage);
    refusal(file, "sonopose-security renew ");
    CHECK_THROWS_WITH(store.read("fusion"), !Contains("error:"));
    THEN("that verb repairs it") {
      store.keys.renew("fusion", year);
      CHECK_NOTHROW(store.read("fusion"));
      CHECK(store.problems().empty());
    }
  }
  WHEN("all enclaves share what is garbage or missing") {
    const fs::path governance = store.keys.folder() / "enclaves/governance.p7s";
    if (GENERATE(true, false)) {
      write_text(governance, "garbage");
    } else {
      fs::remove(governance);
    }
    refusal("governance.p7s", "sonopose-security governance " + store.keys.folder().string());
    store.keys.set_protection({});
    CHECK(store.problems().empty());
  }
  WHEN("its permissions.xml is lost") {
    fs::remove(enclave / "permissions.xml");
    store.keys.renew("fusion", year);
    CHECK(store.problems().empty());
    CHECK(store.read("fusion").grant.access.writes == access_of({"fusion"}).writes);
    AND_WHEN("the signed one is lost too") {
      fs::remove(enclave / "permissions.xml");
      fs::remove(enclave / "permissions.p7s");
      CHECK_THROWS_WITH(store.keys.renew("fusion", year), Contains("permissions.xml") && Contains("revoke") &&
                                                              Contains("sonopose-security enclave"));
      store.keys.revoke("fusion", now_s);
      store.add("fusion", {"fusion"});
      CHECK(store.problems().empty());
    }
  }
  WHEN("it is revoked, and its files come back") {
    const auto key = read_text(enclave / "key.pem");
    const auto certificate = read_text(enclave / "cert.pem");
    store.keys.revoke("fusion", now_s);
    store.add("fusion", {"fusion"});
    write_text(enclave / "key.pem", key);
    write_text(enclave / "cert.pem", certificate);
    refusal("cert.pem", "revoked; run sonopose-security enclave ");
    store.add("fusion", {"fusion"});
    CHECK(store.problems().empty());
  }
  WHEN("the enclave is missing") {
    CHECK_THROWS_WITH(store.read("nobody"), Contains("no such enclave; run sonopose-security enclave"));
  }
  WHEN("others can read the key") {
    fs::permissions(enclave / "key.pem", fs::perms::group_read, fs::perm_options::add);
    refusal("key.pem", "readable by other users");
  }
  WHEN("the certificate has expired, or is from the future") {
    refusal("cert.pem", "expired on 2028-01-15; run sonopose-security renew", year.not_after_s + 1);
    refusal("cert.pem", "clock", year.not_before_s - 10);
  }
  WHEN("the permissions are those of another") {
    fs::copy(other / "permissions.p7s", enclave / "permissions.p7s", fs::copy_options::overwrite_existing);
    refusal("permissions.p7s", "of CN=/consumer");
  }
  WHEN("the permissions were changed") {
    std::string text = read_text(enclave / "permissions.p7s");
    text.replace(text.find("sonopose/pose"), 13, "sonopose/PoSe");
    write_text(enclave / "permissions.p7s", text);
    refusal("permissions.p7s", "changed");
  }
  WHEN("the key is that of another") {
    write_text(enclave / "key.pem", read_text(other / "key.pem"));
    refusal("key.pem", "not the key");
  }
  WHEN("the certificate is of another key store") {
    const Store foreign;
    foreign.add("fusion", {"fusion"});
    for (const char* const file : {"cert.pem", "key.pem"}) {
      write_text(enclave / file, read_text(foreign.keys.enclave_folder("fusion") / file));
    }
    refusal("cert.pem", "not issued by identity_ca.cert.pem; run sonopose-security renew");
    store.keys.renew("fusion", year);
    CHECK(store.problems().empty());
  }
}

SCENARIO("Renewed and revoked enclaves") {
  const Store store;
  store.add("robot/fusion", {"fusion"});
  store.add("bridge", {"bridge"});
  const std::string first = store.read("robot/fusion").serial;
  WHEN("one is renewed") {
    const Validity later{now_s, now_s + 700 * day_s};
    store.keys.renew("robot/fusion", later);
    THEN("it has a new certificate and the same rights") {
      const Enclave renewed = store.read("robot/fusion");
      CHECK(renewed.serial != first);
      CHECK(renewed.expires_s == later.not_after_s);
      CHECK(renewed.grant.access.writes == access_of({"fusion"}).writes);
    }
    THEN("a revocation is of both certificates, and the others go on") {
      const std::string certificate = read_text(store.keys.enclave_folder("robot/fusion") / "cert.pem");
      CHECK(store.keys.revoke("robot/fusion", now_s) == 2);
      CHECK(store.keys.enclaves() == std::vector<std::string>{"bridge"});
      CHECK(store.problems().empty());
      const auto revoked =
          revoked_serials(read_text(store.keys.enclave_folder("bridge") / "crl.pem"),
                          read_text(store.keys.folder() / "public/identity_ca.cert.pem"), "crl.pem");
      CHECK(std::set<std::string>(revoked.begin(), revoked.end()) ==
            std::set<std::string>{first, facts_of(certificate, "cert.pem").serial});
      CHECK_THROWS_AS(store.keys.revoke("robot/fusion", now_s), SecurityError);
    }
  }
  WHEN("a revocation was interrupted before it removed the files") {
    const fs::path folder = store.keys.enclave_folder("bridge");
    const std::string certificate = read_text(folder / "cert.pem");
    CHECK(store.keys.revoke("bridge", now_s) == 1);
    fs::create_directory(folder);
    write_text(folder / "cert.pem", certificate);
    THEN("another one does") {
      CHECK(store.keys.revoke("bridge", now_s) == 0);
      CHECK_FALSE(fs::exists(folder));
    }
  }
  WHEN("the protection changes") {
    CHECK(store.keys.set_protection(Protection::encrypt) == "sign → encrypt");
    CHECK(store.read("bridge").protection == "encrypt");
    THEN("it stays, unless another is asked for") {
      CHECK(store.keys.set_protection({}) == "encrypt → encrypt");
      CHECK(store.read("bridge").protection == "encrypt");
    }
  }
}

SCENARIO("A renewed enclave changes no other one") {
  const Store store;
  store.add("fusion", {"fusion"});
  store.add("consumer", {"consumer"});
  const std::string before = read_text(store.keys.enclave_folder("fusion") / "key.pem");
  for (const char* const file : {"cert.pem", "key.pem", "permissions.p7s"}) {
    const fs::path own = store.keys.enclave_folder("consumer") / file;
    fs::remove(own);
    fs::create_symlink("../fusion/" + std::string(file), own);
  }
  store.keys.renew("consumer", year);
  CHECK(read_text(store.keys.enclave_folder("fusion") / "key.pem") == before);
  CHECK(store.problems().empty());
}

SCENARIO("A link of an enclave to a wrong place is repaired as the refusal says") {
  const Store store;
  store.add("fusion", {"fusion"});
  const std::string file = GENERATE("governance.p7s", "identity_ca.cert.pem", "permissions_ca.cert.pem");
  const fs::path link = store.keys.enclave_folder("fusion") / file;
  fs::remove(link);
  fs::create_symlink("../nowhere/" + file, link);
  CHECK_THROWS_WITH(store.read("fusion"), Contains(file) && Contains("run sonopose-security renew"));
  store.keys.renew("fusion", year);
  CHECK(store.problems().empty());
}

SCENARIO("A certificate that lets others begin the handshake") {
  const Store store;
  store.keys.add("panel", {.roles = {"consumer"}, .validity = year, .handshake = Handshake::answers});
  const std::string subject = store.read("panel").subject;
  CHECK_THAT(subject, Catch::StartsWith("dnQualifier=") && Catch::EndsWith(",CN=/panel"));
  CHECK(store.problems().empty());
  THEN("its subject, which the permissions name, stays when it is renewed") {
    const Validity later{now_s, now_s + 700 * day_s};
    store.keys.renew("panel", later);
    CHECK(store.read("panel").subject == subject);
    CHECK(store.read("panel").expires_s == later.not_after_s);
  }
}

SCENARIO("A name leads to its own enclave only") {
  const Store store;
  store.add("hall", {"bridge"});
  store.add("hall/robot", {"fusion"});
  WHEN("an enclave above another is revoked") {
    const fs::path folder = store.keys.enclave_folder("hall");
    store.keys.revoke("hall", now_s);
    THEN("the other stays, in order") {
      CHECK_FALSE(fs::exists(folder / "key.pem"));
      CHECK(store.keys.enclaves() == std::vector<std::string>{"hall/robot"});
      CHECK(store.problems().empty());
    }
  }
  WHEN("a name is another path of an enclave, or leads out of the store") {
    const std::string name = GENERATE("", ".", "..", "./hall", "hall/", "hall/.", "hall/../hall",
                                      "hall//robot", "../enclaves/hall");
    CAPTURE(name);
    const std::string absolute = store.keys.enclave_folder("hall").string();
    THEN("every verb refuses it, and all enclaves stay") {
      for (const std::string& each : {name, absolute}) {
        CHECK_THROWS_WITH(store.keys.revoke(each, now_s), Contains("not an enclave name"));
        CHECK_THROWS_WITH(store.keys.renew(each, year), Contains("not an enclave name"));
        CHECK_THROWS_WITH(store.add(each, {"bridge"}), Contains("not an enclave name"));
      }
      CHECK(store.keys.enclaves() == std::vector<std::string>{"hall", "hall/robot"});
      CHECK(store.problems().empty());
    }
  }
}

}  // namespace key_store_test
