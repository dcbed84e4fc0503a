// Reads the files of an enclave: byte 0 selects which one the rest is.

#include "security/certificate.hpp"
#include "security/error.hpp"
#include "security/permissions.hpp"
#include "security/revocation.hpp"
#include "security/signed_document.hpp"
#include "support.hpp"

#include <array>

using namespace sonopose;
using namespace sonopose::fuzz;
using security::SecurityError;

namespace {

// A certificate without its key: nobody can sign for it.
constexpr const char* authority = R"PEM(AUTHORITY)PEM";

void read_permissions(const std::string& text) {
  security::Grant grant;
  if (!accepts<SecurityError>([&] { grant = security::grant_of(text, "input"); })) return;
  promise(!security::words_of(grant).empty(), "a grant has words");
  const security::Validity dates{1'800'000'000, 1'900'000'000};
  const security::Grant renewed = security::grant_of(security::with_validity(text, dates, "input"), "renewed");
  promise(renewed.validity.not_before_s == dates.not_before_s && renewed.validity.not_after_s == dates.not_after_s,
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
        promise(!security::is_issued_by(text, authority) || facts.subject == facts.issuer,
                "no certificate passes for one that the authority issued");
      });
      break;
    case 'k':
      accepts<SecurityError>([&] { security::is_key_of(text, authority, "input"); });
      break;
    case 's':
      accepts<SecurityError>([&] { security::verified_document(text, authority, "input"); });
      break;
    default:
      accepts<SecurityError>([&] { security::revoked_serials(text, authority, "input"); });
  }
  return 0;
}
