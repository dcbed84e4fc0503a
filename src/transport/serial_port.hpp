#pragma once
/// \file
/// A beacon's serial line.

#include "transport/byte_source.hpp"

#include <memory>
#include <string>

namespace sonopose::transport {

/// A raw 8N1 line without flow control, at any baud rate that the device can do. A device that is not there,
/// or goes away, is waited for and opened again: read() then says `disconnected` once, `timeout` while it
/// waits, and `connected` when it is back. The path is looked up anew each time, so a udev link
/// (/dev/serial/by-id/…) follows a device that comes back under another number.
class SerialPort : public ByteSource {
public:
  /// Opens nothing yet: the first read() does. Throws files::IoError for a baud rate of 0 and for a path that exists
  /// and is no device.
  SerialPort(std::string device, unsigned baud);
  ~SerialPort() override;

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override;
  void stop() override;
  [[nodiscard]] std::string name() const override;

  /// Why the device is not open; empty while it is.
  [[nodiscard]] std::string last_error() const override;

private:
  class Line;
  std::unique_ptr<Line> line_;
};

}  // namespace sonopose::transport
