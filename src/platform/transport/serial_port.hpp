#pragma once
/// \file
/// A beacon's serial line.

#include "transport/byte_source.hpp"

#include <memory>
#include <string>

namespace sonopose::transport {

/// A raw 8N1 line without flow control, at any baud rate that the device supports. Waits for a device that is
/// absent or unplugged and opens it again: read() returns `disconnected` once, `timeout` while it waits, and
/// `connected` when the device is back. The path is resolved each time, so a udev link (/dev/serial/by-id/…)
/// follows a device that returns under another number.
class SerialPort : public ByteLink {
public:
  /// The first read() opens the device. Throws files::IoError for a baud rate of 0, for a path that exists
  /// and is not a serial device, and for a relative path of nothing.
  SerialPort(std::string device, unsigned baud);
  ~SerialPort() override;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override;
  void stop() override;
  void send(std::vector<std::uint8_t> bytes) override;
  [[nodiscard]] std::uint64_t unsent() const override;
  /// The device's path.
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] std::string description() const override;

  /// Waiting while the device is absent, failed while it is present but unusable.
  [[nodiscard]] LineState state() const override;

  /// The reason why the device is not open; empty while it is.
  [[nodiscard]] std::string last_error() const override;

private:
  class Line;
  std::unique_ptr<Line> line_;
};

}  // namespace sonopose::transport
