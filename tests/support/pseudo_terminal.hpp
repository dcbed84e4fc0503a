#pragma once
/// \file
/// A serial line without hardware, which the kernel treats as it treats the real ones.

#include <cstdint>
#include <span>
#include <string>

namespace sonopose::test {

/// The beacon's end of a line. Its destruction is the unplugging.
class PseudoTerminal {
public:
  /// Throws std::system_error.
  PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;
  PseudoTerminal(PseudoTerminal&&) = delete;
  PseudoTerminal& operator=(PseudoTerminal&&) = delete;
  ~PseudoTerminal();

  /// The host's end, as a device name.
  [[nodiscard]] const std::string& device() const { return device_; }

  /// Writes all of it, waiting for room. Throws std::system_error.
  void send(std::span<const std::uint8_t> bytes) const;

private:
  int file_;
  std::string device_;
};

}  // namespace sonopose::test
