#pragma once
/// \file
/// A pseudo-terminal as a serial line without hardware.

#include <cstdint>
#include <span>
#include <string>

namespace sonopose::test {

/// The beacon's side of the line; its destruction unplugs the beacon.
class PseudoTerminal {
public:
  /// Throws std::system_error on failure.
  PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  ~PseudoTerminal();

  /// Device name of the host's side.
  [[nodiscard]] const std::string& device() const { return device_; }

  /// Writes all bytes; blocks while the buffer is full. Throws std::system_error.
  void send(std::span<const std::uint8_t> bytes) const;

  /// Writes what fits into the buffer; the rest is lost, as on a line without flow control.
  void send_what_fits(std::span<const std::uint8_t> bytes) const;

private:
  int file_;
  std::string device_;
};

}  // namespace sonopose::test
