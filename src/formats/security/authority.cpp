#include "security/authority.hpp"

#include "security/openssl.hpp"

#include <array>

namespace sonopose::security {
namespace {

const unsigned char* bytes_of(const std::string& text) {
  return reinterpret_cast<const unsigned char*>(text.c_str());
}

void set_name(X509_NAME* name, const std::string& common_name) {
  if (X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8, bytes_of(common_name), -1, -1, 0) != 1) {
    ERR_clear_error();
    throw SecurityError(common_name + ": not a name of 1 to 64 bytes");
  }
}

/// Adds the first qualifier that gives the subject one of the highest hashes, one of 65,536.
void qualify_to_answer(X509_NAME* name) {
  const int at = X509_NAME_entry_count(name);
  for (int qualifier = 1;; ++qualifier) {
    const std::string text = std::to_string(qualifier);
    openssl::check(X509_NAME_add_entry_by_txt(name, "dnQualifier", MBSTRING_ASC, bytes_of(text), -1, -1, 0),
                   "X509_NAME_add_entry_by_txt");
    std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
    openssl::check(X509_NAME_digest(name, EVP_sha256(), hash.data(), nullptr), "X509_NAME_digest");
    if (hash[0] == 0xff && hash[1] == 0xff) return;
    X509_NAME_ENTRY_free(X509_NAME_delete_entry(name, at));
  }
}

void set_serial(X509* certificate) {
  constexpr int bits = 127;  // positive, in 16 bytes
  const auto number = openssl::owned<openssl::BigNumber>(BN_new(), "BN_new");
  openssl::check(BN_rand(number.get(), bits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY), "BN_rand");
  if (BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) == nullptr) {
    openssl::fail("BN_to_ASN1_INTEGER");
  }
}

void add_extension(X509* certificate, int id, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* const extension = X509V3_EXT_conf_nid(nullptr, &context, id, value);
  if (extension == nullptr) openssl::fail("X509V3_EXT_conf_nid");
  const int added = X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
  openssl::check(added, "X509_add_ext");
}

std::string pem_of(X509* certificate) {
  const openssl::Bio text = openssl::writing();
  openssl::check(PEM_write_bio_X509(text.get(), certificate), "PEM_write_bio_X509");
  return openssl::text_in(text.get());
}

std::string pem_of(EVP_PKEY* key) {
  const openssl::Bio text = openssl::writing();
  openssl::check(PEM_write_bio_PrivateKey(text.get(), key, nullptr, nullptr, 0, nullptr, nullptr),
                 "PEM_write_bio_PrivateKey");
  return openssl::text_in(text.get());
}

struct Extensions {
  const char* constraints;
  const char* usage;
};

/// Makes a certificate with a new key. Without an authority, it signs itself.
KeyPair make(const KeyPair* authority, const std::string& common_name, const Validity& validity,
             const Extensions& extensions, Handshake handshake = Handshake::either) {
  const auto key = openssl::owned<openssl::Key>(EVP_EC_gen("P-256"), "EVP_EC_gen");
  const auto certificate = openssl::owned<openssl::Cert>(X509_new(), "X509_new");
  openssl::check(X509_set_version(certificate.get(), X509_VERSION_3), "X509_set_version");
  set_serial(certificate.get());
  set_name(X509_get_subject_name(certificate.get()), common_name);
  if (handshake == Handshake::answers) qualify_to_answer(X509_get_subject_name(certificate.get()));
  ASN1_TIME_set(X509_getm_notBefore(certificate.get()), static_cast<time_t>(validity.not_before_s));
  ASN1_TIME_set(X509_getm_notAfter(certificate.get()), static_cast<time_t>(validity.not_after_s));
  openssl::check(X509_set_pubkey(certificate.get(), key.get()), "X509_set_pubkey");
  add_extension(certificate.get(), NID_basic_constraints, extensions.constraints);
  add_extension(certificate.get(), NID_key_usage, extensions.usage);
  const openssl::Cert issuer =
      authority == nullptr ? nullptr : openssl::certificate_of(authority->certificate_pem, "authority");
  const openssl::Key issuer_key =
      authority == nullptr ? nullptr : openssl::key_of(authority->key_pem, "authority");
  openssl::check(X509_set_issuer_name(certificate.get(),
                                      X509_get_subject_name(issuer ? issuer.get() : certificate.get())),
                 "X509_set_issuer_name");
  openssl::check(X509_sign(certificate.get(), issuer_key ? issuer_key.get() : key.get(), EVP_sha256()),
                 "X509_sign");
  return {pem_of(certificate.get()), pem_of(key.get())};
}

}  // namespace

KeyPair make_identity_authority(const std::string& common_name, const Validity& validity) {
  return make(nullptr, common_name, validity, {"critical,CA:TRUE,pathlen:0", "critical,keyCertSign,cRLSign"});
}

KeyPair make_permissions_authority(const std::string& common_name, const Validity& validity) {
  return make(nullptr, common_name, validity, {"critical,CA:FALSE", "critical,digitalSignature"});
}

KeyPair issue(const KeyPair& authority, const std::string& common_name, const Validity& validity,
              Handshake handshake) {
  return make(&authority, common_name, validity, {"critical,CA:FALSE", "critical,digitalSignature"},
              handshake);
}

}  // namespace sonopose::security
