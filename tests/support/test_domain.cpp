#include "support/test_domain.hpp"

#include <fcntl.h>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <sys/file.h>
#include <unistd.h>

namespace sonopose::test {

TestDomain::TestDomain() {
  constexpr std::uint32_t domains = 100;
  const auto first = static_cast<std::uint32_t>(::getpid());
  for (std::uint32_t i = 0; i < domains; ++i) {
    id_ = 1 + (first + i) % domains;
    const auto name =
        std::filesystem::temp_directory_path() / ("sonopose-test-domain-" + std::to_string(id_) + ".lock");
    lock_file_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock_file_ >= 0 && ::flock(lock_file_, LOCK_EX | LOCK_NB) == 0) return;
    if (lock_file_ >= 0) ::close(lock_file_);
  }
  throw std::runtime_error(
      "all test domains are taken (sonopose-test-domain-*.lock in the temporary folder)");
}

TestDomain::~TestDomain() {
  ::close(lock_file_);  // releases the lock
}

}  // namespace sonopose::test
