#include "transport/tty_settings.hpp"

#include <cerrno>
#include <cstring>

// Linux's termios2 takes the baud rate as a number. Its header and the C library's <termios.h> exclude each
// other, hence this file.
#include <asm/termbits.h>
#include <sys/file.h>
#include <sys/ioctl.h>

namespace sonopose::transport {

bool lock_serial_line(int descriptor) {
  return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::ioctl(descriptor, TIOCEXCL) == 0;
}

std::string configure_serial_line(int descriptor, unsigned baud) {
  termios2 line{};
  if (::ioctl(descriptor, TCGETS2, &line) != 0) return std::strerror(errno);
  line.c_iflag = IGNBRK | IGNPAR;
  line.c_oflag = 0;
  line.c_lflag = 0;
  line.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
  line.c_ispeed = baud;
  line.c_ospeed = baud;
  line.c_cc[VMIN] = 1;
  line.c_cc[VTIME] = 0;
  if (::ioctl(descriptor, TCSETS2, &line) != 0) return std::strerror(errno);
  // A driver silently replaces an unsupported rate. A UART tolerates 3 %.
  if (::ioctl(descriptor, TCGETS2, &line) != 0) return std::strerror(errno);
  const double ratio = static_cast<double>(line.c_ospeed) / static_cast<double>(baud);
  if (ratio < 0.97 || ratio > 1.03) {
    return "it uses " + std::to_string(line.c_ospeed) + " baud instead of " + std::to_string(baud);
  }
  return {};
}

}  // namespace sonopose::transport
