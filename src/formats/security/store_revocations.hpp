#pragma once
/// \file
/// The list of revoked certificates of a key store: public/crl.pem, and a copy that only the store's owner
/// can read. Private to this folder.

#include <filesystem>
#include <string>

namespace sonopose::security {

/// Returns the public list or its private copy, whichever can be read and lacks no certificate of the other.
/// So an older one does not admit again what was revoked since. Empty if the store has none. Throws
/// SecurityError.
std::string revocations(const std::filesystem::path& store, const std::string& issuer_pem);

/// Writes the list and its copy, which comes first.
void write_revocations(const std::filesystem::path& store, const std::string& list);

}  // namespace sonopose::security
