#pragma once
/// \file
/// A beacon's serial line.

#include "transport/byte_source.hpp"

#include <memory>
#include <string>

namespace sonopose::transport {

/// Makes a raw 8N1 line without flow control, at any baud rate that the device supports. It waits for a
/// device that is absent or unplugged and opens it again: read() returns `disconnected` once, `timeout` while
/// it waits, and `connected` when the device is back. The path is resolved each time, so a udev link
/// (/dev/serial/by-id/…) follows a device that returns under another number.
///
/// state(): waiting while the device is absent, failed while it is present but unusable. The first read()
/// opens the device. Throws files::IoError for a baud rate of 0, for a path that exists and is not a serial
/// device, and for a relative path of nothing.
std::unique_ptr<ByteLink> open_serial_port(std::string device, unsigned baud);

}  // namespace sonopose::transport
