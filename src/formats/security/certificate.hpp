#pragma once
/// \file
/// Certificates and their keys, as PEM texts.

#include <cstdint>
#include <string>

namespace sonopose::security {

inline constexpr std::int64_t day_s = 86'400;

/// Seconds since 1970.
struct Validity {
  std::int64_t not_before_s = 0;
  std::int64_t not_after_s = 0;
};

/// A certificate and its private key.
struct KeyPair {
  std::string certificate_pem;
  std::string key_pem;
};

/// Content of a certificate.
struct CertificateFacts {
  std::string subject;  ///< "CN=/bridge"
  std::string issuer;
  std::string serial;  ///< hexadecimal
  Validity validity;
};

/// Reads a certificate. Throws SecurityError with `origin`, the name of the file.
CertificateFacts facts_of(const std::string& certificate_pem, const std::string& origin);

/// Returns true if the authority signed the certificate, whatever their dates.
bool is_issued_by(const std::string& certificate_pem, const std::string& authority_pem);

/// Returns true if a file holds a certificate that the authority issued, other than its own: one or several
/// in PEM, or one in DER. Anything else in the file is passed over.
bool holds_leaf_of(const std::string& content, const std::string& authority_pem);

/// Returns true if the private key belongs to the certificate. Throws SecurityError for an unreadable key.
bool is_key_of(const std::string& key_pem, const std::string& certificate_pem, const std::string& origin);

/// Returns a date as in 2026-11-29.
std::string date_text(std::int64_t time_s);

/// Returns a date and time as in 2026-11-29T18:00:00, in UTC.
std::string date_time_text(std::int64_t time_s);

}  // namespace sonopose::security
