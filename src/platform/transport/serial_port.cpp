#include "transport/serial_port.hpp"

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "transport/device_access.hpp"
#include "transport/serial_line.hpp"
#include "transport/stoppable_loop.hpp"

#include <asio/buffer.hpp>
#include <asio/serial_port.hpp>
#include <asio/steady_timer.hpp>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace sonopose::transport {

namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds retry_period{100};

std::chrono::milliseconds until(steady_clock::time_point time) {
  return std::max(std::chrono::milliseconds{0},
                  std::chrono::ceil<std::chrono::milliseconds>(time - steady_clock::now()));
}

/// Returns true if there is no device, false if it cannot be opened.
bool is_absence(const asio::error_code& error) {
  // asio's category does not map to std::errc.
  return error.value() == ENOENT || error.value() == ENODEV || error.value() == ENXIO;
}

}  // namespace

class SerialPort::Line {
public:
  Line(std::string device, unsigned baud) : device_{std::move(device)}, baud_{baud}, port_{loop_.context()} {
    if (baud_ == 0) throw files::IoError(device_ + ": a baud rate of 0 closes the line");
    std::error_code ignored;
    const auto kind = std::filesystem::status(device_, ignored).type();
    using Kind = std::filesystem::file_type;
    if (kind == Kind::regular || kind == Kind::directory)
      throw files::IoError(device_ + ": is not a serial device");
  }

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) {
    if (loop_.stopped()) return {ReadStatus::stopped};
    return port_.is_open() ? read_open(buffer, timeout) : wait_for_device(timeout);
  }

  void stop() { loop_.stop(); }
  [[nodiscard]] const std::string& name() const { return device_; }
  [[nodiscard]] std::string description() const { return device_ + " at " + std::to_string(baud_) + " baud"; }
  [[nodiscard]] LineState state() const { return state_; }
  [[nodiscard]] const std::string& last_error() const { return last_error_; }

private:
  ReadResult read_open(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) {
    SteadyTime arrival;
    const auto start = [&](auto finish) {
      port_.async_read_some(asio::buffer(buffer.data(), buffer.size()),
                            [&arrival, finish](const asio::error_code& error, std::size_t size) {
                              arrival = clocks::steady_now();
                              finish(error, size);
                            });
    };
    const Completion done = complete_within(loop_, timeout, start, [this] { port_.cancel(); });
    if (!done.error) return {ReadStatus::data, done.size, arrival};
    if (loop_.stopped()) return {ReadStatus::stopped};
    if (done.error == asio::error::operation_aborted) return {ReadStatus::timeout};
    close(done.error == asio::error::eof ? "the device hung up" : done.error.message(), LineState::waiting);
    reported_ = {state_, {}};
    return {ReadStatus::disconnected};
  }

  /// Returns true if the cause is to be reported: once, and again when another one keeps the device from
  /// being used.
  bool is_new_cause() {
    // The first reason is irrelevant while the port waits for an absent device.
    const std::pair cause{state_, state_ == LineState::waiting ? std::string() : last_error_};
    return std::exchange(reported_, cause) != cause;
  }

  ReadResult wait_for_device(std::chrono::milliseconds timeout) {
    const auto deadline = steady_clock::now() + timeout;
    for (;;) {
      if (steady_clock::now() >= next_attempt_) {
        if (open()) return {ReadStatus::connected};
        if (is_new_cause()) return {ReadStatus::disconnected};
      }
      sleep(until(std::min(deadline, next_attempt_)));
      if (loop_.stopped()) return {ReadStatus::stopped};
      if (steady_clock::now() >= deadline) return {ReadStatus::timeout};
    }
  }

  /// Returns why the device could not be opened.
  [[nodiscard]] std::string reason_of(const asio::error_code& error) const {
    if (error.value() == ENOENT) return "it does not exist";
    if (error.value() == EACCES) return error.message() + ": " + access_remedy(device_);
    return error.message();
  }

  bool open() {
    asio::error_code error;
    port_.open(device_, error);
    if (error) {
      close(reason_of(error), is_absence(error) ? LineState::waiting : LineState::failed);
      return false;
    }
    const std::string cause = configure_serial_line(port_.native_handle(), baud_);
    if (!cause.empty()) {
      close(cause, LineState::failed);
      return false;
    }
    state_ = LineState::open;
    last_error_.clear();
    reported_ = {LineState::open, {}};
    return true;
  }

  void close(const std::string& cause, LineState state) {
    state_ = state;
    asio::error_code ignored;
    port_.close(ignored);
    last_error_ = cause;
    next_attempt_ = steady_clock::now() + retry_period;
  }

  void sleep(std::chrono::milliseconds duration) {
    asio::steady_timer timer{loop_.context(), duration};
    complete_within(
        loop_, duration + retry_period, [&timer](auto finish) { timer.async_wait(finish); },
        [&timer] { timer.cancel(); });
  }

  std::string device_;
  unsigned baud_;
  StoppableLoop loop_;
  asio::serial_port port_;
  LineState state_ = LineState::closed;
  std::string last_error_ = "not opened yet";
  std::pair<LineState, std::string> reported_{LineState::closed, {}};  ///< state and its cause
  steady_clock::time_point next_attempt_;
};

SerialPort::SerialPort(std::string device, unsigned baud)
    : line_{std::make_unique<Line>(std::move(device), baud)} {}

SerialPort::~SerialPort() = default;

ReadResult SerialPort::read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) {
  return line_->read(buffer, timeout);
}

void SerialPort::stop() {
  line_->stop();
}

std::string SerialPort::name() const {
  return line_->name();
}

std::string SerialPort::description() const {
  return line_->description();
}

LineState SerialPort::state() const {
  return line_->state();
}

std::string SerialPort::last_error() const {
  return line_->last_error();
}

}  // namespace sonopose::transport
