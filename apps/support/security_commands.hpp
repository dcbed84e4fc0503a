#pragma once
// The commands of sonopose-security.

#include "security/permissions.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::apps {

struct SecurityOptions {
  std::filesystem::path store;
  std::vector<std::string> names;
  std::vector<std::string> roles;
  std::vector<std::string> partitions;
  bool for_fastdds = false;
  std::optional<int> days;  ///< none: a year, or what the enclave had
  security::Protection protection = security::Protection::sign;
  std::optional<security::Protection> new_protection;  ///< none: that of governance.xml
};

/// Each prints what it did, and returns the exit code.
int make_store(const SecurityOptions& options);
int add_enclaves(const SecurityOptions& options);
int list_enclaves(const SecurityOptions& options);
int check_store(const SecurityOptions& options);
int renew_enclaves(const SecurityOptions& options);
int revoke_enclaves(const SecurityOptions& options);
int set_governance(const SecurityOptions& options);

}  // namespace sonopose::apps
