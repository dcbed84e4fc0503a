#pragma once
/// \file
/// Line settings that asio cannot express. Internal to this module.

#include <string>

namespace sonopose::transport {

/// Locks an open tty until it is closed: a second reader would steal bytes. TIOCEXCL keeps other programs of
/// ordinary users from opening it, flock the programs of this project, whose user may be root. Returns false
/// with errno, which is EWOULDBLOCK if another process has the lock.
bool lock_serial_line(int descriptor);

/// Configures an open tty as a raw 8N1 line without flow control at any baud rate. Returns the cause of a
/// failure, else an empty text.
std::string configure_serial_line(int descriptor, unsigned baud);

}  // namespace sonopose::transport
