#pragma once
/// \file
/// A DDS domain for one test process alone.

#include <cstdint>

namespace sonopose::test {

/// Takes one of the domains 1 … 100 for as long as it lives: a lock on a file per domain in the temporary
/// folder, so that no two tests of this machine share one. (The ports of these domains lie below those that
/// the kernel gives to anybody; domain 0 belongs to people; the tests of the DDS layer use those from 101
/// on.)
class TestDomain {
public:
  /// Throws std::runtime_error where all are taken.
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
