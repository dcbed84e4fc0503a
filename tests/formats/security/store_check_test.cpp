#include "files/input_file.hpp"
#include "security/authority.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/new_store.hpp"
#include "security/revocation.hpp"
#include "security/signed_document.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace store_check_test {

using namespace sonopose::security;
using namespace sonopose::security::test;
using namespace sonopose::test;
using Catch::Contains;
namespace fs = std::filesystem;
namespace files = sonopose::files;

SCENARIO("A check is also of the authorities") {
  const Store store;
  REQUIRE(store.problems().empty());
  WHEN("others can read a private key of an authority, or list their folder") {
    const fs::path open = store.keys.folder() / GENERATE("private", "private/identity_ca.key.pem",
                                                         "private/permissions_ca.key.pem");
    CAPTURE(open);
    fs::permissions(open, fs::perms::group_read, fs::perm_options::add);
    const auto problems = store.problems();
    REQUIRE(problems.size() == 1);
    CHECK(problems.front().subject == open.string());
    CHECK_THAT(problems.front().text, Contains("chmod"));
  }
  WHEN("a file cannot be checked, which could be a certificate of theirs") {
    const fs::path file = store.keys.folder() / "large.pem";
    write_text(file, "");
    fs::resize_file(file, files::max_text_bytes + 1);  // sparse
    const auto problems = store.problems();
    REQUIRE(problems.size() == 1);
    CHECK(problems.front().subject == file.string());
    CHECK_THAT(problems.front().text, Contains("bytes, the limit") && !Contains("large.pem"));
  }
  WHEN("a certificate of theirs is missing") {
    const fs::path file = store.keys.folder() / "public" / "identity_ca.cert.pem";
    fs::remove(file);
    const auto problems = store.problems();
    REQUIRE(problems.size() == 1);
    CHECK(problems.front().subject == file.string());
    CHECK_THAT(problems.front().text, !Contains(file.string()));
  }
  WHEN("a key cannot be read") {
    store.add("bridge", {"bridge"});
    const fs::path key = store.keys.enclave_folder("bridge") / "key.pem";
    fs::resize_file(key, files::max_text_bytes + 1);
    const auto problems = store.problems();
    REQUIRE(problems.size() == 1);
    CHECK(problems.front().subject == "bridge");
  }
  WHEN("a certificate is broken") {
    write_text(store.keys.folder() / "broken.pem", "-----BEGIN CERTIFICATE-----\nnone");
    CHECK(store.problems().empty());
  }
  WHEN("they expire, in a store without an enclave") {
    const auto problems = store.problems(now_s + 3700 * day_s);
    REQUIRE(problems.size() == 2);
    CHECK_THAT(problems.front().text, Contains("expired on"));
    CHECK_THAT(problems.front().subject, Contains("identity_ca.cert.pem"));
    CHECK_THAT(problems.back().subject, Contains("permissions_ca.cert.pem"));
  }
}

SCENARIO("A check finds what programs would miss") {
  const Store store;
  store.add("fusion", {"fusion"});
  store.add("consumer", {"consumer"});
  const fs::path enclave = store.keys.enclave_folder("consumer");
  const auto problem = [&] {
    const auto problems = store.problems();
    REQUIRE(problems.size() == 1);
    return problems.front().subject + ": " + problems.front().text;
  };
  WHEN("the files of another enclave are in its folder") {
    for (const char* const file : {"cert.pem", "key.pem", "permissions.p7s"}) {
      write_text(enclave / file, read_text(store.keys.enclave_folder("fusion") / file));
    }
    CHECK_THAT(problem(), Contains("consumer: has the files of CN=/fusion; run sonopose-security renew"));
    store.keys.renew("consumer", year);
    CHECK(store.problems().empty());
    AND_WHEN("its permissions.xml is that of the other too") {
      write_text(enclave / "permissions.xml",
                 read_text(store.keys.enclave_folder("fusion") / "permissions.xml"));
      CHECK_THROWS_WITH(store.keys.renew("consumer", year), Contains("of CN=/fusion, not of this enclave"));
    }
  }
  WHEN("what can be edited was, and not signed") {
    const bool is_governance = GENERATE(true, false);
    const fs::path edited =
        is_governance ? store.keys.folder() / "enclaves/governance.xml" : enclave / "permissions.xml";
    write_text(edited, read_text(edited) + "<!-- edited -->\n");
    CHECK_THAT(problem(),
               Contains(edited.string()) && Contains("not in force; run sonopose-security " +
                                                     std::string(is_governance ? "governance" : "renew")));
    if (is_governance) {
      store.keys.set_protection({});
    } else {
      store.keys.renew("consumer", year);
    }
    CHECK(store.problems().empty());
  }
  WHEN("the list of revoked certificates is deleted after a revocation") {
    const std::string serial = store.read("consumer").serial;
    const std::string older = read_text(store.keys.folder() / "public/crl.pem");
    store.keys.revoke("consumer", now_s);
    fs::remove(store.keys.folder() / "public/crl.pem");
    CHECK_THAT(problem(), Contains("fusion/crl.pem: does not exist; run sonopose-security renew"));
    THEN("no program starts, also without the link") {
      CHECK_THROWS_WITH(store.read("fusion"), Contains("crl.pem"));
      fs::remove(store.keys.enclave_folder("fusion") / "crl.pem");
      CHECK_THROWS_WITH(store.read("fusion"), Contains("crl.pem"));
    }
    THEN("it comes back with the certificates that were on it") {
      store.keys.renew("fusion", year);
      CHECK(store.problems().empty());
      CHECK(revoked_serials(read_text(store.keys.enclave_folder("fusion") / "crl.pem"),
                            read_text(store.keys.folder() / "public/identity_ca.cert.pem"),
                            "crl.pem") == std::vector<std::string>{serial});
      AND_WHEN("an older list, without the revocation, takes its place") {
        write_text(store.keys.folder() / "public/crl.pem", older);
        store.keys.renew("fusion", year);
        THEN("the revocation is still known") {
          CHECK(revoked_serials(read_text(store.keys.folder() / "public/crl.pem"),
                                read_text(store.keys.folder() / "public/identity_ca.cert.pem"),
                                "crl.pem") == std::vector<std::string>{serial});
        }
      }
      AND_WHEN("its copy is lost as well") {
        fs::remove(store.keys.folder() / "public/crl.pem");
        fs::remove(store.keys.folder() / "private/crl.pem");
        CHECK_THROWS_WITH(store.keys.renew("fusion", year),
                          Contains("public/crl.pem: does not exist") && Contains("another machine"));
      }
    }
  }
}

SCENARIO("The expiries of a store are those of all its readable enclaves") {
  const Store store;
  store.add("bridge", {"bridge"});
  store.add("hall/robot", {"fusion"});
  store.add("broken", {"monitor"});
  write_text(store.keys.enclave_folder("broken") / "cert.pem", "no certificate");
  const std::map<std::string, std::int64_t> expected{{"bridge", year.not_after_s},
                                                     {"hall/robot", year.not_after_s}};
  CHECK(expiries_beside(store.keys.enclave_folder("bridge")) == expected);
  CHECK(expiries_beside(store.keys.enclave_folder("hall/robot")) == expected);
  CHECK(expiries_beside({}).empty());
}

/// Returns the bytes between the first and the last line of a text in PEM.
std::string der_of(const std::string& pem) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned buffer = 0;
  int bits = 0;
  const std::size_t begin = pem.find('\n');
  for (const char each : pem.substr(begin, pem.rfind("-----END") - begin)) {
    const std::size_t value = digits.find(each);
    if (value == digits.npos) continue;
    buffer = (buffer << 6U | static_cast<unsigned>(value)) & 0xffffU;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(buffer >> static_cast<unsigned>(bits) & 0xffU);
  }
  return bytes;
}

SCENARIO("A leaf under the permissions authority is refused (CVE-2023-24011)") {
  const Store store;
  store.add("consumer", {"consumer"});
  const fs::path shared = store.keys.folder() / "public";
  const KeyPair common = make_identity_authority("sros2CA", year);  // one that may issue, as of SROS2
  const KeyPair leaf = issue(common, "/consumer", year);
  const std::string document = signed_document("<dds/>", leaf);
  const std::string store_certificate = read_text(shared / "identity_ca.cert.pem");
  WHEN("a store has such an authority, and a certificate under it") {
    write_text(shared / "permissions_ca.cert.pem", common.certificate_pem);
    const std::size_t before = store.problems().size();
    const TemporaryFolder elsewhere;
    const std::string kind = GENERATE("alone", "behind another", "in DER", "behind a link");
    CAPTURE(kind);
    const fs::path place = kind == "behind a link" ? elsewhere / "other.pem" : shared / "other.pem";
    write_text(place, kind == "behind another" ? store_certificate + "text\n" + leaf.certificate_pem
                      : kind == "in DER"       ? der_of(leaf.certificate_pem)
                                               : leaf.certificate_pem);
    if (kind == "behind a link") fs::create_symlink(place, shared / "other.pem");
    THEN("check names the certificate") {
      const auto problems = store.problems();
      REQUIRE(problems.size() == before + 1);
      CHECK(problems.front().subject == (shared / "other.pem").string());
      CHECK_THAT(problems.front().text, Contains("CVE-2023-24011"));
    }
  }
  WHEN("it signs a document") {
    THEN("its signature is refused, also by name") {
      CHECK_THROWS_WITH(verified_document(document, common.certificate_pem, "permissions.p7s"),
                        Contains("permissions.p7s") && Contains("CVE-2023-24011"));
    }
  }
  WHEN("our permissions authority issues one all the same") {
    const KeyPair ours{read_text(shared / "permissions_ca.cert.pem"),
                       read_text(store.keys.folder() / "private/permissions_ca.key.pem")};
    const KeyPair forbidden = issue(ours, "/consumer", year);
    THEN("its certificate already forbids that") {
      CHECK_THROWS_WITH(
          verified_document(signed_document("<dds/>", forbidden), ours.certificate_pem, "permissions.p7s"),
          Contains("not signed by the permissions authority"));
      CHECK_THAT(verified_document(signed_document("<dds/>\n", ours), ours.certificate_pem, "x"),
                 Contains("<dds/>"));
    }
  }
}

}  // namespace store_check_test
