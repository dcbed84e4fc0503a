#pragma once
/// \file
/// A key store of a test.

#include "security/enclave.hpp"
#include "security/key_store.hpp"
#include "support/temporary_folder.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace sonopose::security::test {

inline constexpr std::int64_t now_s = 1'800'000'000;  // 2027-01-15
inline constexpr Validity year{now_s - day_s, now_s + 365 * day_s};

/// A store without enclaves in a folder of its own.
struct Store {
  sonopose::test::TemporaryFolder folder;
  KeyStore keys = KeyStore::create(folder / "keys", Protection::sign, now_s);

  void add(const std::string& name, const std::vector<std::string>& roles) const {
    keys.add(name, {.roles = roles, .validity = year});
  }
  [[nodiscard]] Enclave read(const std::string& name, std::int64_t at_s = now_s) const {
    return read_enclave(keys.enclave_folder(name), at_s);
  }
  [[nodiscard]] std::vector<StoreProblem> problems(std::int64_t at_s = now_s) const {
    return check(keys, at_s);
  }
};

}  // namespace sonopose::security::test
