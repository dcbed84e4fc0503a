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
namespace {

class UdpPeer final : public ByteLink {
public:
  UdpPeer(const Endpoint& peer, std::uint16_t local_port)
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

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override {
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
    return {ReadStatus::data, done.size, arrival, {.address = {}, .port = sender.port()}};
  }

  void stop() override { loop_.stop(); }
  void answer_last_sender() override {
    if (last_sender_) peer_ = *last_sender_;
  }

  void send(std::vector<std::uint8_t> bytes) override {
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

  [[nodiscard]] std::uint64_t unsent() const override { return unsent_; }
  [[nodiscard]] SendFailures send_failures() const override {
    const std::uint64_t count = failures_;
    return {.count = count, .reason = std::errc{failure_.load()}};
  }
  [[nodiscard]] std::string name() const override { return name_; }

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

}  // namespace

std::unique_ptr<ByteLink> open_udp_peer(const Endpoint& peer, std::uint16_t local_port) {
  return std::make_unique<UdpPeer>(peer, local_port);
}

}  // namespace sonopose::transport
