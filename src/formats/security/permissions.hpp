#pragma once
/// \file
/// The documents of DDS Security: permissions of an enclave, and the governance of the domain.

#include "security/certificate.hpp"
#include "security/roles.hpp"

#include <string>
#include <vector>

namespace sonopose::security {

/// Rights of one subject, and their dates.
struct Grant {
  std::string subject;  ///< "CN=/bridge", or "dnQualifier=4711,CN=/panel"
  Validity validity;
  Access access;
  std::vector<std::string> partitions;  ///< names or patterns, "" for none; empty: only without one
};

/// Protection of the messages on the bus.
enum class Protection : bool {
  sign,    ///< no stranger can send or change them
  encrypt  ///< nor read them
};

/// Returns the permissions with this grant, in every domain.
std::string permissions_xml(const Grant& grant);

/// Reads permissions. Throws SecurityError with `origin`, the name of the file, also for several grants and
/// for parts that are not understood, such as rules that deny.
Grant grant_of(const std::string& xml, const std::string& origin);

/// Returns the permissions with other dates and all else unchanged.
std::string with_validity(const std::string& xml, const Validity& validity, const std::string& origin);

/// Returns the governance of all domains: members prove who they are, and each topic has access control.
std::string governance_xml(Protection protection);

/// Returns how a governance protects the data of topics: "sign", "encrypt" or "mixed".
std::string protection_in(const std::string& governance, const std::string& origin);

/// Returns the partitions of a grant, separated by commas.
std::string partitions_text(const Grant& grant);

/// Returns what a grant allows, in words.
std::string words_of(const Grant& grant);

}  // namespace sonopose::security
