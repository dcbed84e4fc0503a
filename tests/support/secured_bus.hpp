#pragma once
/// \file
/// A bus with DDS Security: a key store with an enclave for each role, which the programs of the test and its
/// own consumers find by ROS 2's variables.

#include "clocks/clocks.hpp"
#include "security/enclave.hpp"
#include "security/key_store.hpp"
#include "support/bus.hpp"
#include "support/temporary_folder.hpp"

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace sonopose::test {

inline std::int64_t time_now_s() {
  return clocks::host_now() / 1'000'000'000;
}

/// Dates from yesterday on.
inline security::Validity valid_for(std::int64_t duration_s) {
  return {time_now_s() - security::day_s, time_now_s() + duration_s};
}

class KeyStoreOfRoles {
public:
  explicit KeyStoreOfRoles(security::Protection protection = security::Protection::sign)
      : store(security::KeyStore::create(folder_ / "keys", protection, time_now_s())) {
    for (const char* const role : security::role_names) add(role, role, 365 * security::day_s);
  }

  void add(const std::string& name, const std::string& role, std::int64_t duration_s) const {
    store.add(name, {.roles = {role}, .validity = valid_for(duration_s)});
  }

  /// Arguments for an enclave of this store.
  [[nodiscard]] Arguments arguments(const std::string& enclave) const {
    return {"--security", store.folder().string(), "--enclave", enclave};
  }

private:
  TemporaryFolder folder_;

public:
  security::KeyStore store;
};

/// Sets the variables during its lifetime.
class SecuredByEnvironment {
public:
  explicit SecuredByEnvironment(const security::KeyStore& store) {
    ::setenv("ROS_SECURITY_KEYSTORE", store.folder().c_str(), 1);
    ::setenv("ROS_SECURITY_ENABLE", "true", 1);
    ::setenv("ROS_SECURITY_STRATEGY", "Enforce", 1);
  }
  ~SecuredByEnvironment() {
    for (const char* const name : {"KEYSTORE", "ENABLE", "STRATEGY"}) {
      ::unsetenv(("ROS_SECURITY_" + std::string(name)).c_str());
    }
  }
  SecuredByEnvironment(const SecuredByEnvironment&) = delete;
  SecuredByEnvironment& operator=(const SecuredByEnvironment&) = delete;
};

}  // namespace sonopose::test
