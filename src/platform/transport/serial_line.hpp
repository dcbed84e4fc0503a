#pragma once
/// \file
/// Line settings that asio cannot express. Internal to this module.

#include <string>

namespace sonopose::transport {

/// Configures an open tty as a raw 8N1 line without flow control at any baud rate, for exclusive use. Returns
/// the cause of a failure, else an empty text.
std::string configure_serial_line(int descriptor, unsigned baud);

}  // namespace sonopose::transport
