#pragma once
/// \file
/// Owners of OpenSSL's objects. Only sources of this module include it.

#include "security/certificate.hpp"
#include "security/error.hpp"

#include <array>
#include <memory>
#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>
#include <string>
#include <string_view>

namespace sonopose::security::openssl {

template <auto free>
struct Free {
  template <class T>
  void operator()(T* object) const {
    free(object);
  }
};

using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using BigNumber = std::unique_ptr<BIGNUM, Free<BN_free>>;
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using Cert = std::unique_ptr<X509, Free<X509_free>>;
using Crl = std::unique_ptr<X509_CRL, Free<X509_CRL_free>>;
using Pkcs7 = std::unique_ptr<PKCS7, Free<PKCS7_free>>;
using Store = std::unique_ptr<X509_STORE, Free<X509_STORE_free>>;
using Time = std::unique_ptr<ASN1_TIME, Free<ASN1_TIME_free>>;

/// Throws SecurityError with OpenSSL's reason.
[[noreturn]] inline void fail(const std::string& what) {
  std::array<char, 256> reason{"unknown error"};
  if (const unsigned long code = ERR_get_error(); code != 0) {
    ERR_error_string_n(code, reason.data(), reason.size());
  }
  ERR_clear_error();
  throw SecurityError(what + ": " + reason.data());
}

/// Throws SecurityError unless OpenSSL's result is positive.
inline void check(int result, const char* what) {
  if (result <= 0) fail(what);
}

/// Takes an object over. Throws SecurityError if there is none.
template <class Owner>
Owner owned(typename Owner::pointer object, const std::string& what) {
  if (object == nullptr) fail(what);
  return Owner(object);
}

/// Takes over what was in a file. Throws SecurityError with `problem` if it held no such thing: OpenSSL's
/// reason names no file and no remedy.
template <class Owner>
Owner found(typename Owner::pointer object, const std::string& problem) {
  ERR_clear_error();
  if (object == nullptr) throw SecurityError(problem);
  return Owner(object);
}

inline Bio reading(std::string_view text) {
  return owned<Bio>(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), "BIO_new_mem_buf");
}

inline Bio writing() {
  return owned<Bio>(BIO_new(BIO_s_mem()), "BIO_new");
}

inline std::string text_in(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return {data, static_cast<std::size_t>(size)};
}

/// `origin` names the file in errors.
inline Cert certificate_of(const std::string& pem, const std::string& origin) {
  return found<Cert>(PEM_read_bio_X509(reading(pem).get(), nullptr, nullptr, nullptr),
                     origin + ": not a certificate");
}

inline Key key_of(const std::string& pem, const std::string& origin) {
  const char* const no_password = "";
  return found<Key>(
      PEM_read_bio_PrivateKey(reading(pem).get(), nullptr, nullptr, const_cast<char*>(no_password)),
      origin + ": not a private key, or one with a password");
}

/// Seconds since 1970.
inline std::int64_t seconds_of(const ASN1_TIME* time) {
  const auto epoch = owned<Time>(ASN1_TIME_set(nullptr, 0), "ASN1_TIME_set");
  int days = 0;
  int seconds = 0;
  check(ASN1_TIME_diff(&days, &seconds, epoch.get(), time), "ASN1_TIME_diff");
  return std::int64_t{days} * 86'400 + seconds;
}

inline std::string hexadecimal(const ASN1_INTEGER* serial) {
  const auto number = owned<BigNumber>(ASN1_INTEGER_to_BN(serial, nullptr), "ASN1_INTEGER_to_BN");
  char* const text = BN_bn2hex(number.get());
  if (text == nullptr) fail("BN_bn2hex");
  std::string result(text);
  OPENSSL_free(text);
  return result;
}

}  // namespace sonopose::security::openssl
