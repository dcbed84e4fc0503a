#pragma once
/// \file
/// Documents signed with S/MIME, as `openssl smime -sign -text` signs them.

#include "security/certificate.hpp"

#include <string>

namespace sonopose::security {

/// Returns the document with the authority's signature.
std::string signed_document(const std::string& text, const KeyPair& authority);

/// Returns the text of a signed document. Throws SecurityError, with `origin` as the name of the file, unless
/// the authority itself signed it.
std::string verified_document(const std::string& document, const std::string& authority_pem,
                              const std::string& origin);

}  // namespace sonopose::security
