#include "support/pseudo_terminal.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::test {
namespace {

void require(bool good, const char* call) {
  if (!good) throw std::system_error(errno, std::generic_category(), call);
}

}  // namespace

PseudoTerminal::PseudoTerminal() : file_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)) {
  require(file_ >= 0, "posix_openpt");
  require(::grantpt(file_) == 0 && ::unlockpt(file_) == 0, "unlockpt");
  std::array<char, 128> name{};
  require(::ptsname_r(file_, name.data(), name.size()) == 0, "ptsname_r");
  device_ = name.data();
}

PseudoTerminal::~PseudoTerminal() {
  ::close(file_);
}

void PseudoTerminal::send(std::span<const std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EAGAIN) {
      pollfd waited{file_, POLLOUT, 0};
      ::poll(&waited, 1, -1);
      continue;
    }
    require(written > 0, "write to a pseudo-terminal");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void PseudoTerminal::send_what_fits(std::span<const std::uint8_t> bytes) const {
  const ssize_t written = ::write(file_, bytes.data(), bytes.size());
  require(written >= 0 || errno == EAGAIN, "write to a pseudo-terminal");
}

}  // namespace sonopose::test
