#pragma once
/// \file
/// The list of the certificates that an authority revoked.

#include "security/certificate.hpp"

#include <string>
#include <vector>

namespace sonopose::security {

/// Returns a list of these serial numbers (hexadecimal), valid as long as the authority.
std::string revocation_list(const KeyPair& authority, const std::vector<std::string>& serials,
                            std::int64_t now_s);

/// Returns the serial numbers in a list. Throws SecurityError, with `origin` as the name of the file, unless
/// the authority signed it.
std::vector<std::string> revoked_serials(const std::string& list_pem, const std::string& authority_pem,
                                         const std::string& origin);

}  // namespace sonopose::security
