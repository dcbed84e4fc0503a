#pragma once
/// \file
/// The two authorities of a key store, and the certificates that the first one issues.

#include "security/certificate.hpp"

#include <cstdint>
#include <string>

namespace sonopose::security {

/// Makes an authority that issues certificates. It can issue no further authorities.
KeyPair make_identity_authority(const std::string& common_name, const Validity& validity);

/// Makes an authority that signs documents. Its certificate forbids the issue of certificates: Cyclone DDS
/// would accept permissions signed with any of those (CVE-2023-24011).
KeyPair make_permissions_authority(const std::string& common_name, const Validity& validity);

/// The side of a handshake that a holder of a certificate takes: DDS Security lets the participant with the
/// lower GUID begin, and the GUID starts with the hash of the certificate's subject.
enum class Handshake : std::uint8_t {
  either,  ///< the hash of the common name decides which side begins
  answers  ///< a qualifier in the subject makes the hash so high that practically every other begins
};

/// Issues a certificate with a new key (EC P-256); its subject depends on name and handshake alone. Throws
/// SecurityError for a name of more than 64 bytes.
KeyPair issue(const KeyPair& authority, const std::string& common_name, const Validity& validity,
              Handshake handshake = Handshake::either);

}  // namespace sonopose::security
