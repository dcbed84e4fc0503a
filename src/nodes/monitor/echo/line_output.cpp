#include "monitor/echo/line_output.hpp"

#include <climits>

#include <algorithm>
#include <cerrno>
#include <poll.h>
#include <system_error>
#include <unistd.h>

namespace sonopose::monitor::echo {

bool LineOutput::write(std::string_view lines) {
  constexpr int check_stop_ms = 100;
  while (!lines.empty()) {
    pollfd output{fd_, POLLOUT, 0};
    if (::poll(&output, 1, check_stop_ms) <= 0) {
      if (stop_.requested()) return false;
      continue;
    }
    // A ready pipe takes this much without blocking, so that the stop is noticed.
    const ssize_t written = ::write(fd_, lines.data(), std::min<std::size_t>(lines.size(), PIPE_BUF));
    if (written < 0 && errno == EPIPE) return false;
    if (written < 0 && errno != EINTR && errno != EAGAIN) {
      throw std::system_error(errno, std::generic_category(), "the output cannot be written");
    }
    lines.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
  return true;
}

bool LineOutput::is_closed() const {
  pollfd output{fd_, 0, 0};
  return ::poll(&output, 1, 0) > 0 && (output.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace sonopose::monitor::echo
