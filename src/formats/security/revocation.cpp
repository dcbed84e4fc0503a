#include "security/revocation.hpp"

#include "security/openssl.hpp"

namespace sonopose::security {
namespace {

void add(X509_CRL* list, const std::string& serial, const ASN1_TIME* now) {
  BIGNUM* number = nullptr;
  if (BN_hex2bn(&number, serial.c_str()) == 0) openssl::fail(serial + ": no serial number");
  const openssl::BigNumber owned(number);
  X509_REVOKED* const entry = X509_REVOKED_new();
  ASN1_INTEGER* const integer = BN_to_ASN1_INTEGER(number, nullptr);
  if (entry == nullptr || integer == nullptr) openssl::fail("X509_REVOKED_new");
  X509_REVOKED_set_serialNumber(entry, integer);
  ASN1_INTEGER_free(integer);
  X509_REVOKED_set_revocationDate(entry, const_cast<ASN1_TIME*>(now));
  openssl::check(X509_CRL_add0_revoked(list, entry), "X509_CRL_add0_revoked");
}

}  // namespace

std::string revocation_list(const KeyPair& authority, const std::vector<std::string>& serials,
                            std::int64_t now_s) {
  const openssl::Cert issuer = openssl::certificate_of(authority.certificate_pem, "authority");
  const openssl::Key key = openssl::key_of(authority.key_pem, "authority");
  const auto list = openssl::owned<openssl::Crl>(X509_CRL_new(), "X509_CRL_new");
  // A list from the future would be refused by a machine whose clock is behind.
  const auto now = openssl::owned<openssl::Time>(ASN1_TIME_set(nullptr, static_cast<time_t>(now_s - day_s)),
                                                 "ASN1_TIME_set");
  openssl::check(X509_CRL_set_version(list.get(), X509_CRL_VERSION_2), "X509_CRL_set_version");
  openssl::check(X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(issuer.get())),
                 "X509_CRL_set_issuer_name");
  openssl::check(X509_CRL_set1_lastUpdate(list.get(), now.get()), "X509_CRL_set1_lastUpdate");
  openssl::check(X509_CRL_set1_nextUpdate(list.get(), X509_get0_notAfter(issuer.get())),
                 "X509_CRL_set1_nextUpdate");
  for (const std::string& serial : serials) add(list.get(), serial, now.get());
  openssl::check(X509_CRL_sort(list.get()), "X509_CRL_sort");
  openssl::check(X509_CRL_sign(list.get(), key.get(), EVP_sha256()), "X509_CRL_sign");
  const openssl::Bio text = openssl::writing();
  openssl::check(PEM_write_bio_X509_CRL(text.get(), list.get()), "PEM_write_bio_X509_CRL");
  return openssl::text_in(text.get());
}

std::vector<std::string> revoked_serials(const std::string& list_pem, const std::string& authority_pem,
                                         const std::string& origin) {
  const auto list = openssl::found<openssl::Crl>(
      PEM_read_bio_X509_CRL(openssl::reading(list_pem).get(), nullptr, nullptr, nullptr),
      origin + ": not a list of revoked certificates");
  const openssl::Cert authority = openssl::certificate_of(authority_pem, "authority");
  if (X509_CRL_verify(list.get(), X509_get0_pubkey(authority.get())) != 1) {
    ERR_clear_error();
    throw SecurityError(origin + ": not signed by the identity authority");
  }
  std::vector<std::string> serials;
  STACK_OF(X509_REVOKED)* const entries = X509_CRL_get_REVOKED(list.get());
  for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
    serials.push_back(
        openssl::hexadecimal(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(entries, i))));
  }
  return serials;
}

}  // namespace sonopose::security
