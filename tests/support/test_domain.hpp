#pragma once
/// \file
/// A DDS domain for one test process.

#include <cstdint>

namespace sonopose::test {

/// Reserves one of the domains 1 … 100 during its lifetime. A lock file per domain in the temporary folder
/// ensures that no two tests on this machine share one. Their ports lie below the ephemeral ports; domain 0
/// is left to users. The Python and shell tests lock the same files.
class TestDomain {
public:
  /// Throws std::runtime_error if all domains are in use.
  TestDomain();
  TestDomain(const TestDomain&) = delete;
  TestDomain& operator=(const TestDomain&) = delete;
  ~TestDomain();

  [[nodiscard]] std::uint32_t id() const { return id_; }

private:
  std::uint32_t id_ = 0;
  int lock_file_ = -1;
};

}  // namespace sonopose::test
