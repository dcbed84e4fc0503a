#include "transport/udp_peer.hpp"

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "transport/stoppable_loop.hpp"

#include <asio/buffer.hpp>
#include <asio/ip/udp.hpp>

#include <atomic>
#include <optional>
#include <stdexcept>
#include <utility>

namespace sonopose::transport {

class UdpPeer::Socket {
public:
  Socket(const Endpoint& peer, std::uint16_t local_port)
      : name_("udp " + peer.address + " port " + std::to_string(peer.port)), socket_{loop_.context()} {
    asio::error_code error;
    peer_ = {asio::ip::make_address(peer.address, error), peer.port};
    if (!error) socket_.open(peer_.protocol(), error);
    if (!error) socket_.bind({peer_.protocol(), local_port}, error);
    if (!error) socket_.non_blocking(true, error);
    if (error) {
      const std::string cause =
          "cannot bind local port " + std::to_string(local_port) + ": " + error.message();
      if (error == asio::error::access_denied) throw std::invalid_argument("--local-port: " + cause);
      throw files::IoError(name_ + ": " + cause);
    }
  }

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) {
    if (loop_.stopped()) return {ReadStatus::stopped};
    SteadyTime arrival;
    asio::ip::udp::endpoint sender;
    const auto start = [&](auto finish) {
      socket_.async_receive_from(asio::buffer(buffer.data(), buffer.size()), sender,
                                 [&arrival, finish](const asio::error_code& error, std::size_t size) {
                                   arrival = clocks::steady_now();
                                   finish(error, size);
                                 });
    };
    const Completion done = complete_within(loop_, timeout, start, [this] { socket_.cancel(); });
    if (loop_.stopped()) return {ReadStatus::stopped};
    if (done.error == asio::error::operation_aborted) return {ReadStatus::timeout};
    if (done.error) throw files::IoError(name_ + ": cannot be read: " + done.error.message());
    if (sender.address() != peer_.address()) return {ReadStatus::refused};
    last_sender_ = sender;
    return {ReadStatus::data, done.size, arrival};
  }

  void stop() { loop_.stop(); }
  void answer_last_sender() {
    if (last_sender_) peer_ = *last_sender_;
  }

  void send(std::vector<std::uint8_t> bytes) {
    asio::post(loop_.context(), [this, bytes = std::move(bytes)] {
      asio::error_code error;
      socket_.send_to(asio::buffer(bytes), peer_, 0, error);
      const bool is_full = error == asio::error::would_block || error == asio::error::no_buffer_space;
      if (is_full) {
        ++unsent_;
      } else if (error) {
        failure_ = error.value();
        ++failures_;
      }
    });
  }

  [[nodiscard]] std::uint64_t unsent() const { return unsent_; }
  [[nodiscard]] SendFailures send_failures() const {
    const std::uint64_t count = failures_;
    return {.count = count, .reason = std::errc{failure_.load()}};
  }
  [[nodiscard]] const std::string& name() const { return name_; }

private:
  std::string name_;
  StoppableLoop loop_;
  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint peer_;                        ///< used by the reading thread only
  std::optional<asio::ip::udp::endpoint> last_sender_;  ///< likewise
  std::atomic<std::uint64_t> unsent_ = 0;
  std::atomic<std::uint64_t> failures_ = 0;
  std::atomic<int> failure_ = 0;  ///< errno of the last one, set before it is counted
};

UdpPeer::UdpPeer(const Endpoint& peer, std::uint16_t local_port)
    : socket_{std::make_unique<Socket>(peer, local_port)} {}

UdpPeer::~UdpPeer() = default;

ReadResult UdpPeer::read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) {
  return socket_->read(buffer, timeout);
}

void UdpPeer::stop() {
  socket_->stop();
}

void UdpPeer::send(std::vector<std::uint8_t> bytes) {
  socket_->send(std::move(bytes));
}

void UdpPeer::answer_last_sender() {
  socket_->answer_last_sender();
}

std::uint64_t UdpPeer::unsent() const {
  return socket_->unsent();
}

SendFailures UdpPeer::send_failures() const {
  return socket_->send_failures();
}

std::string UdpPeer::name() const {
  return socket_->name();
}

}  // namespace sonopose::transport
