#include "transport/serial_port.hpp"

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "transport/device_access.hpp"
#include "transport/stoppable_loop.hpp"
#include "transport/tty_settings.hpp"

#include <asio/buffer.hpp>
#include <asio/serial_port.hpp>
#include <asio/steady_timer.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace sonopose::transport {

namespace {

using std::chrono::steady_clock;

constexpr std::chrono::milliseconds retry_period{100};
/// Period for a device that is there, but cannot be used: finding the cause takes milliseconds.
constexpr std::chrono::milliseconds slow_retry_period{1000};

std::chrono::milliseconds until(steady_clock::time_point time) {
  return std::max(std::chrono::milliseconds{0},
                  std::chrono::ceil<std::chrono::milliseconds>(time - steady_clock::now()));
}

/// Returns true if there is no device, false if it cannot be opened.
bool is_absence(int error) {
  return error == ENOENT || error == ENODEV || error == ENXIO;
}

/// Returns true for a path of a device, or an absolute one of nothing yet.
bool may_be_serial_device(const std::string& path) {
  std::error_code ignored;
  if (!path.starts_with('/') && !std::filesystem::exists(path, ignored)) return false;
  const auto kind = std::filesystem::status(path, ignored).type();
  using Kind = std::filesystem::file_type;
  const bool is_other_kind = kind == Kind::regular || kind == Kind::directory || kind == Kind::block ||
                             kind == Kind::fifo || kind == Kind::socket;
  return !is_other_kind && !is_other_device(path);
}

class SerialPort final : public ByteLink {
public:
  SerialPort(std::string device, unsigned baud)
      : device_{std::move(device)}, baud_{baud}, port_{loop_.context()} {
    if (baud_ == 0) throw files::IoError(device_ + ": a baud rate of 0 closes the line");
    if (!may_be_serial_device(device_))
      throw files::IoError('"' + device_ + "\" is not a serial device; " + serial_devices());
  }

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override {
    if (loop_.stopped()) return {ReadStatus::stopped};
    return port_.is_open() ? read_open(buffer, timeout) : wait_for_device(timeout);
  }

  void stop() override { loop_.stop(); }
  void send(std::vector<std::uint8_t> bytes) override {
    asio::post(loop_.context(), [this, bytes = std::move(bytes)] {
      if (!port_.is_open()) return;
      const ssize_t written = ::write(port_.native_handle(), bytes.data(), bytes.size());
      const bool is_full = written < 0 ? errno == EAGAIN : written < static_cast<ssize_t>(bytes.size());
      if (is_full) ++unsent_;
    });
  }
  [[nodiscard]] std::uint64_t unsent() const override { return unsent_; }
  [[nodiscard]] std::string name() const override { return device_; }
  [[nodiscard]] std::string description() const override {
    const std::string line = device_ + " at " + std::to_string(baud_) + " baud";
    return others_.empty() ? line : line + "; " + others_ + " has it open too and may take bytes";
  }
  [[nodiscard]] LineState state() const override { return state_; }
  [[nodiscard]] std::string last_error() const override { return last_error_; }

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
  [[nodiscard]] std::string reason_of(int error) const {
    const std::string text = std::generic_category().message(error);
    if (error == ENOENT) return "it does not exist; " + serial_devices();
    if (error == EACCES) return text + ": " + access_remedy(device_);
    if (error == EBUSY) return used_by_others();
    return text;
  }

  [[nodiscard]] std::string used_by_others() const {
    const std::string users = users_of(device_);
    return "it is in use by " +
           (users.empty() ? "another process: sudo fuser -v " + device_ + " shows which" : users);
  }

  /// Prepares a device that was opened. Returns the cause of a failure, else an empty text.
  [[nodiscard]] std::string prepare(int descriptor) const {
    if (::isatty(descriptor) == 0 && errno == ENOTTY) return "it is not a serial device";
    if (!lock_serial_line(descriptor)) {
      return errno == EWOULDBLOCK ? used_by_others() : std::generic_category().message(errno);
    }
    return configure_serial_line(descriptor, baud_);
  }

  bool open() {
    const int descriptor = ::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0) {
      const int error = errno;
      close(reason_of(error), is_absence(error) ? LineState::waiting : LineState::failed);
      return false;
    }
    std::string cause = prepare(descriptor);
    asio::error_code error;
    if (cause.empty()) port_.assign(descriptor, error);
    if (error) cause = error.message();
    if (!cause.empty()) {
      ::close(descriptor);
      close(cause, LineState::failed);
      return false;
    }
    state_ = LineState::open;
    last_error_.clear();
    others_ = users_of(device_);
    reported_ = {LineState::open, {}};
    return true;
  }

  void close(const std::string& cause, LineState state) {
    state_ = state;
    asio::error_code ignored;
    port_.close(ignored);
    last_error_ = cause;
    others_.clear();
    next_attempt_ = steady_clock::now() + (state == LineState::failed ? slow_retry_period : retry_period);
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
  std::string others_;  ///< other processes that had the device open when this one opened it
  std::pair<LineState, std::string> reported_{LineState::closed, {}};  ///< state and its cause
  steady_clock::time_point next_attempt_;
  std::atomic<std::uint64_t> unsent_ = 0;
};

}  // namespace

std::unique_ptr<ByteLink> open_serial_port(std::string device, unsigned baud) {
  return std::make_unique<SerialPort>(std::move(device), baud);
}

}  // namespace sonopose::transport
