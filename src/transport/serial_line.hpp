#pragma once
/// \file
/// The line settings that the portable interface cannot express. Private to this room.

#include <string>

namespace sonopose::transport {

/// Makes an open tty a raw 8N1 line without flow control at any baud rate, for us alone. Gives the cause
/// where the device cannot, else an empty text.
std::string configure_serial_line(int descriptor, unsigned baud);

}  // namespace sonopose::transport
