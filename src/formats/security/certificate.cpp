#include "security/certificate.hpp"

#include "security/openssl.hpp"

#include <fmt/chrono.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace sonopose::security {
namespace {

std::string text_of(const X509_NAME* name) {
  const openssl::Bio text = openssl::writing();
  openssl::check(X509_NAME_print_ex(text.get(), name, 0, XN_FLAG_RFC2253) + 1, "X509_NAME_print_ex");
  return openssl::text_in(text.get());
}

/// Returns all certificates of a file: of a text in PEM with other parts between, or one in DER.
std::vector<openssl::Cert> certificates_in(const std::string& content) {
  std::vector<openssl::Cert> certificates;
  const auto* bytes = reinterpret_cast<const unsigned char*>(content.data());
  if (openssl::Cert alone(d2i_X509(nullptr, &bytes, static_cast<long>(content.size()))); alone) {
    certificates.push_back(std::move(alone));
  }
  const openssl::Bio text = openssl::reading(content);
  for (int left = BIO_pending(text.get()); left > 0;) {
    // The kind "TRUSTED CERTIFICATE" is read too. A broken one is skipped.
    if (openssl::Cert next(PEM_read_bio_X509_AUX(text.get(), nullptr, nullptr, nullptr)); next) {
      certificates.push_back(std::move(next));
    }
    const int still_left = BIO_pending(text.get());
    if (still_left == left) break;
    left = still_left;
  }
  ERR_clear_error();
  return certificates;
}

}  // namespace

CertificateFacts facts_of(const std::string& certificate_pem, const std::string& origin) {
  const openssl::Cert certificate = openssl::certificate_of(certificate_pem, origin);
  return {.subject = text_of(X509_get_subject_name(certificate.get())),
          .issuer = text_of(X509_get_issuer_name(certificate.get())),
          .serial = openssl::hexadecimal(X509_get0_serialNumber(certificate.get())),
          .validity = {openssl::seconds_of(X509_get0_notBefore(certificate.get())),
                       openssl::seconds_of(X509_get0_notAfter(certificate.get()))}};
}

bool is_issued_by(const std::string& certificate_pem, const std::string& authority_pem) {
  const openssl::Cert certificate = openssl::certificate_of(certificate_pem, "certificate");
  const openssl::Cert authority = openssl::certificate_of(authority_pem, "authority");
  const bool is_signed = X509_verify(certificate.get(), X509_get0_pubkey(authority.get())) == 1;
  ERR_clear_error();
  return is_signed;
}

bool holds_leaf_of(const std::string& content, const std::string& authority_pem) {
  const openssl::Cert authority = openssl::certificate_of(authority_pem, "authority");
  const std::vector<openssl::Cert> certificates = certificates_in(content);
  const bool holds = std::ranges::any_of(certificates, [&](const openssl::Cert& each) {
    return X509_cmp(each.get(), authority.get()) != 0 &&
           X509_verify(each.get(), X509_get0_pubkey(authority.get())) == 1;
  });
  ERR_clear_error();
  return holds;
}

bool is_key_of(const std::string& key_pem, const std::string& certificate_pem, const std::string& origin) {
  const openssl::Key key = openssl::key_of(key_pem, origin);
  const openssl::Cert certificate = openssl::certificate_of(certificate_pem, origin);
  const bool fits = X509_check_private_key(certificate.get(), key.get()) == 1;
  ERR_clear_error();
  return fits;
}

std::string date_text(std::int64_t time_s) {
  return date_time_text(time_s).substr(0, 10);
}

std::string date_time_text(std::int64_t time_s) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(time_s)));
}

}  // namespace sonopose::security
