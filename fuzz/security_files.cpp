// Reads the files of an enclave: byte 0 selects which one the rest is.

#include "security/certificate.hpp"
#include "security/error.hpp"
#include "security/permissions.hpp"
#include "security/revocation.hpp"
#include "security/signed_document.hpp"
#include "support.hpp"

#include <string>

using namespace sonopose;
using namespace sonopose::fuzz;
using security::SecurityError;

namespace {

// The authorities of the seeds, whose keys are deleted: nobody can sign for them.
constexpr const char* identity_authority = R"PEM(-----BEGIN CERTIFICATE-----
MIIBYTCCAQigAwIBAgIQWvZOa6A81Iu+T7bnCgF4ZjAKBggqhkjOPQQDAjAfMR0w
GwYDVQQDDBRzb25vcG9zZSBpZGVudGl0eSBDQTAeFw0yNjExMjgyMjIzNTVaFw0z
NjExMjkyMjIzNTVaMB8xHTAbBgNVBAMMFHNvbm9wb3NlIGlkZW50aXR5IENBMFkw
EwYHKoZIzj0CAQYIKoZIzj0DAQcDQgAEPMQQtOoGtqMvim2LjeVIpI9VotigNguT
EVlXiwhxtL4ld1A/M5n/8p7lN0NtHxVr0wfxwHKC6o+mF9fD14V61qMmMCQwEgYD
VR0TAQH/BAgwBgEB/wIBADAOBgNVHQ8BAf8EBAMCAQYwCgYIKoZIzj0EAwIDRwAw
RAIgczZZ52PRowQADs8BGHcMyILXMSC2CQU+JzsBruuwylQCIEYdmR7Hl26jF+Ec
7MY/YIVnXmTAknckCeqF3QoBGPeN
-----END CERTIFICATE-----
)PEM";
constexpr const char* permissions_authority = R"PEM(-----BEGIN CERTIFICATE-----
MIIBYzCCAQigAwIBAgIQQbuCz3Gd8azEKoBs8Nu4SzAKBggqhkjOPQQDAjAiMSAw
HgYDVQQDDBdzb25vcG9zZSBwZXJtaXNzaW9ucyBDQTAeFw0yNjExMjgyMjIzNTVa
Fw0zNjExMjkyMjIzNTVaMCIxIDAeBgNVBAMMF3Nvbm9wb3NlIHBlcm1pc3Npb25z
IENBMFkwEwYHKoZIzj0CAQYIKoZIzj0DAQcDQgAEF63P6xYHEqsmtOzk5mtpMh9G
y5jUX0849SrVIbgV9W2LDSW/Ck4qi+dq1RWlbY+EgZYNGCfMFK6UUWI9CUZzuqMg
MB4wDAYDVR0TAQH/BAIwADAOBgNVHQ8BAf8EBAMCB4AwCgYIKoZIzj0EAwIDSQAw
RgIhANBO9hFvSd3Jd0PUxl5Qvq2UujQSRxzecg64+JxQJ6nHAiEA47Rft1wrxEru
/1TFlZmbFIKY4TYpZw5M3fIsnbQbKlA=
-----END CERTIFICATE-----
)PEM";

void read_permissions(const std::string& text) {
  security::Grant grant;
  if (!accepts<SecurityError>([&] { grant = security::grant_of(text, "input"); })) return;
  promise(!security::words_of(grant).empty(), "a grant has words");
  const security::Validity dates{1'800'000'000, 1'900'000'000};
  const security::Grant renewed =
      security::grant_of(security::with_validity(text, dates, "input"), "renewed");
  promise(renewed.validity.not_before_s == dates.not_before_s &&
              renewed.validity.not_after_s == dates.not_after_s,
          "renewed permissions have the new dates");
  promise(renewed.access.writes == grant.access.writes && renewed.access.reads == grant.access.reads &&
              renewed.subject == grant.subject && renewed.partitions == grant.partitions,
          "a renewal changes no rights");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(text_of(data + 1, size - 1));
  switch (data[0]) {
    case 'p':
      read_permissions(text);
      break;
    case 'g':
      accepts<SecurityError>([&] { security::protection_in(text, "input"); });
      break;
    case 'c':
      accepts<SecurityError>([&] {
        const security::CertificateFacts facts = security::facts_of(text, "input");
        promise(!security::date_time_text(facts.validity.not_after_s).empty(), "a date has a text");
        if (security::is_issued_by(text, identity_authority)) {
          promise(security::facts_of(identity_authority, "authority").subject == facts.issuer,
                  "an issued certificate names its authority");
        }
      });
      break;
    case 'k':
      accepts<SecurityError>([&] { security::is_key_of(text, identity_authority, "input"); });
      break;
    case 's':
      accepts<SecurityError>([&] {
        const std::string document = security::verified_document(text, permissions_authority, "input");
        promise(document.find("<dds ") != document.npos, "what the authority signed is unchanged");
      });
      break;
    default:
      accepts<SecurityError>([&] { security::revoked_serials(text, identity_authority, "input"); });
  }
  return 0;
}
