#include "security/signed_document.hpp"

#include "security/openssl.hpp"

namespace sonopose::security {

std::string signed_document(const std::string& text, const KeyPair& authority) {
  constexpr int flags = PKCS7_DETACHED | PKCS7_TEXT | PKCS7_STREAM;
  const openssl::Bio content = openssl::reading(text);
  const openssl::Cert signer = openssl::certificate_of(authority.certificate_pem, "authority");
  const openssl::Key key = openssl::key_of(authority.key_pem, "authority");
  const auto signature = openssl::owned<openssl::Pkcs7>(
      PKCS7_sign(signer.get(), key.get(), nullptr, content.get(), flags), "PKCS7_sign");
  const openssl::Bio document = openssl::writing();
  openssl::check(SMIME_write_PKCS7(document.get(), signature.get(), content.get(), flags),
                 "SMIME_write_PKCS7");
  return openssl::text_in(document.get());
}

std::string verified_document(const std::string& document, const std::string& authority_pem,
                              const std::string& origin) {
  const openssl::Cert authority = openssl::certificate_of(authority_pem, "authority");
  BIO* content = nullptr;
  const auto signature = openssl::found<openssl::Pkcs7>(
      SMIME_read_PKCS7(openssl::reading(document).get(), &content), origin + ": not a signed document");
  const openssl::Bio owned_content(content);
  const auto store = openssl::owned<openssl::Store>(X509_STORE_new(), "X509_STORE_new");
  openssl::check(X509_STORE_add_cert(store.get(), authority.get()), "X509_STORE_add_cert");
  // The dates of the authority are reported elsewhere, with a better text.
  X509_STORE_set_flags(store.get(), X509_V_FLAG_NO_CHECK_TIME);
  const openssl::Bio text = openssl::writing();
  if (PKCS7_verify(signature.get(), nullptr, store.get(), content, text.get(), PKCS7_TEXT) != 1) {
    ERR_clear_error();
    throw SecurityError(origin + ": not signed by the permissions authority, or changed since");
  }
  STACK_OF(X509)* const signers = PKCS7_get0_signers(signature.get(), nullptr, 0);
  const bool by_authority = signers != nullptr && sk_X509_num(signers) == 1 &&
                            X509_cmp(sk_X509_value(signers, 0), authority.get()) == 0;
  sk_X509_free(signers);
  if (!by_authority) {
    throw SecurityError(origin +
                        ": signed by a certificate under the permissions authority, which Cyclone "
                        "DDS accepts too (CVE-2023-24011)");
  }
  return openssl::text_in(text.get());
}

}  // namespace sonopose::security
