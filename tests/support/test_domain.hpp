#pragma once
/// \file
/// A DDS domain for one test process.

#include <cstdint>

namespace sonopose::test {

/// Reserves one of the domains 1 … 100 during its lifetime, with a lock file per domain in the temporary
/// folder, so that no two tests of this machine share one. The ports of these domains are below the ephemeral
/// ports; domain 0 is for users. The tests in Python and in shell lock the same files.
class TestDomain {
public:
  /// Throws std::runtime_error if all are in use.
  TestDomain();
  TestDomain(const TestDomain&) = delete;
  TestDomain& operator=(const TestDomain&) = delete;
  TestDomain(TestDomain&&) = delete;
  TestDomain& operator=(TestDomain&&) = delete;
  ~TestDomain();

  [[nodiscard]] std::uint32_t id() const { return id_; }

private:
  std::uint32_t id_ = 0;
  int lock_file_ = -1;
};

}  // namespace sonopose::test
