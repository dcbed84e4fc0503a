#pragma once
/// \file
/// Where raw beacon bytes come from: one interface for serial line, UDP and file.

#include <sonopose/samples/samples.hpp>

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

namespace sonopose::transport {

enum class ReadStatus : std::uint8_t {
  data,          ///< `size` bytes are in the buffer
  timeout,       ///< nothing came
  connected,     ///< the device has been opened
  disconnected,  ///< the device is gone or not there; it is waited for
  end,           ///< there will be no more
  stopped        ///< stop() was called
};

struct ReadResult {
  ReadStatus status = ReadStatus::timeout;
  std::size_t size = 0;
  TimeNs arrival_time_ns = 0;  ///< host clock, right after the read that gave the data
};

class ByteSource {
public:
  ByteSource() = default;
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  ByteSource(ByteSource&&) = delete;
  ByteSource& operator=(ByteSource&&) = delete;

  /// Waits at most `timeout` for bytes and gives what is there, be it little. One thread at a time. A signal
  /// does not end the wait, so a program that ends by a flag of its signal handler uses a timeout below a
  /// second.
  virtual ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) = 0;

  /// From any thread (but not from a signal handler): ends a running read() at once, and all later ones.
  virtual void stop() = 0;

  /// Why there is nothing to read from; empty while there is, or where that cannot be.
  [[nodiscard]] virtual std::string last_error() const { return {}; }

  /// For messages, such as "/dev/ttyACM0 at 500000 baud".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// The host's clock: ns since the Unix epoch.
TimeNs host_time_ns();

}  // namespace sonopose::transport
