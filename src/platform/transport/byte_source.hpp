#pragma once
/// \file
/// The interface of sources of raw beacon bytes: serial line, UDP and file.

#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/status.hpp>

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <system_error>
#include <vector>

namespace sonopose::transport {

enum class ReadStatus : std::uint8_t {
  data,          ///< `size` bytes are in the buffer
  timeout,       ///< no bytes arrived
  refused,       ///< a datagram of a sender that is not accepted
  connected,     ///< the device has been opened
  disconnected,  ///< the device is absent; further reads wait for it
  end,           ///< no more bytes
  stopped        ///< stop() was called
};

/// The sender of a datagram. All bytes of a serial line or file have the same sender.
struct Sender {
  std::array<std::uint8_t, 16> address{};  ///< IPv6, or IPv4 mapped to IPv6
  std::uint16_t port = 0;                  ///< 0: not a datagram's

  bool operator==(const Sender&) const = default;
};

/// Returns a text such as "10.0.0.5:49100", without the port if it is 0.
std::string text_of(const Sender& sender);

struct ReadResult {
  ReadStatus status = ReadStatus::timeout;
  std::size_t size = 0;
  SteadyTime arrival = {};  ///< time immediately after the read that returned the data
  Sender sender = {};
};

class ByteSource {
public:
  ByteSource() = default;
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Waits for at most `timeout` and returns the available bytes. One thread at a time. A signal does not end
  /// the wait, so a program that checks a stop flag uses a timeout below a second.
  virtual ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) = 0;

  /// Ends a running read() immediately, and all later ones. Any thread may call it, but not a signal handler.
  virtual void stop() = 0;

  /// The state of the source after the last read().
  [[nodiscard]] virtual LineState state() const { return LineState::open; }

  /// The reason why the source is not open; empty while it is.
  [[nodiscard]] virtual std::string last_error() const { return {}; }

  /// The name, such as "/dev/ttyACM0".
  [[nodiscard]] virtual std::string name() const = 0;

  /// A description for messages, such as "/dev/ttyACM0 at 500000 baud".
  [[nodiscard]] virtual std::string description() const { return name(); }
};

/// Messages that could not be sent at all, other than for a full line.
struct SendFailures {
  std::uint64_t count = 0;
  std::errc reason{};  ///< error of the last one
};

/// A line in both directions.
class ByteLink : public ByteSource {
public:
  /// Sends bytes from the thread that reads, which this wakes. Any thread may call it. They are dropped while
  /// the line is closed or takes no more.
  virtual void send(std::vector<std::uint8_t> bytes) = 0;

  /// Sends to the sender of the last data from now on, where a line has several. On the thread that reads.
  virtual void answer_last_sender() {}

  /// Number of messages for which an open line was too full, at least in part. Thread-safe.
  [[nodiscard]] virtual std::uint64_t unsent() const = 0;

  /// Failures since the start. Thread-safe.
  [[nodiscard]] virtual SendFailures send_failures() const { return {}; }
};

}  // namespace sonopose::transport
