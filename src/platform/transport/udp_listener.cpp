#include "transport/udp_listener.hpp"

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "transport/stoppable_loop.hpp"

#include <asio/buffer.hpp>
#include <asio/ip/udp.hpp>

#include <charconv>
#include <stdexcept>
#include <system_error>

namespace sonopose::transport {

namespace {

std::string text_of(const Endpoint& endpoint) {
  const bool is_v6 = endpoint.address.find(':') != std::string::npos;
  return (is_v6 ? "[" + endpoint.address + "]" : endpoint.address) + ":" + std::to_string(endpoint.port);
}

asio::ip::address_v6::bytes_type mapped_bytes(const asio::ip::address& address) {
  if (address.is_v6()) return address.to_v6().to_bytes();
  return asio::ip::make_address_v6(asio::ip::v4_mapped, address.to_v4()).to_bytes();
}

/// Throws std::invalid_argument.
asio::ip::address address_of(const std::string& text) {
  asio::error_code error;
  const auto address = asio::ip::make_address(text, error);
  if (error) throw std::invalid_argument("\"" + text + "\" is not a numeric IP address");
  return address;
}

/// Parses the address of a sender.
std::optional<asio::ip::address_v6::bytes_type> parse_sender(const std::optional<std::string>& text) {
  if (!text) return std::nullopt;
  return mapped_bytes(address_of(*text));
}

}  // namespace

std::string text_of(const Sender& sender) {
  const asio::ip::address_v6 v6{sender.address};
  const std::string address =
      v6.is_v4_mapped() ? asio::ip::make_address_v4(asio::ip::v4_mapped, v6).to_string() : v6.to_string();
  return sender.port == 0 ? address : text_of(Endpoint{address, sender.port});
}

Endpoint parse_endpoint(std::string_view text) {
  const auto fail = [text](const std::string& why) -> void {
    throw std::invalid_argument("\"" + std::string(text) + "\" is not ADDR:PORT: " + why);
  };
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) fail("the colon and the port are missing");
  std::string_view address = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (address.starts_with('[') && address.ends_with(']')) {
    address = address.substr(1, address.size() - 2);
  } else if (address.find(':') != std::string_view::npos) {
    fail("an IPv6 address needs brackets, as in [::]:49100");
  }
  asio::error_code error;
  asio::ip::make_address(std::string(address), error);
  if (error) fail("\"" + std::string(address) + "\" is not a numeric IP address");
  Endpoint endpoint{std::string(address), 0};
  const auto result = std::from_chars(port.data(), port.data() + port.size(), endpoint.port);
  if (port.empty() || result.ec != std::errc{} || result.ptr != port.data() + port.size()) {
    fail("\"" + std::string(port) + "\" is not a port from 0 to 65535");
  }
  return endpoint;
}

void check_address(const std::string& text) {
  address_of(text);
}

namespace {

class UdpListener final : public ByteSource {
public:
  UdpListener(const Endpoint& endpoint, const std::optional<std::string>& from)
      : from_{parse_sender(from)}, socket_{loop_.context()} {
    asio::error_code error;
    const auto address = asio::ip::make_address(endpoint.address, error);
    const asio::ip::udp::endpoint local{address, endpoint.port};
    if (!error) socket_.open(local.protocol(), error);
    if (!error) socket_.bind(local, error);
    if (error) {
      const std::string cause = "cannot listen on " + text_of(endpoint) + ": " + error.message();
      if (error == asio::error::access_denied) throw std::invalid_argument("--listen: " + cause);
      throw files::IoError(cause);
    }
    // Room for bursts while the reader is busy; the system may grant less.
    socket_.set_option(asio::socket_base::receive_buffer_size(1 << 20), error);
  }

  ReadResult read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) override {
    if (loop_.stopped()) return {ReadStatus::stopped};
    ReadResult result;
    asio::ip::udp::endpoint peer;
    const auto start = [&](auto finish) {
      socket_.async_receive_from(asio::buffer(buffer.data(), buffer.size()), peer,
                                 [&result, finish](const asio::error_code& error, std::size_t size) {
                                   result.arrival = clocks::steady_now();
                                   finish(error, size);
                                 });
    };
    const Completion done = complete_within(loop_, timeout, start, [this] { socket_.cancel(); });
    if (!done.error) {
      const auto address = mapped_bytes(peer.address());
      if (from_ && *from_ != address) return {ReadStatus::refused};
      return {ReadStatus::data, done.size, result.arrival, {address, peer.port()}};
    }
    if (loop_.stopped()) return {ReadStatus::stopped};
    if (done.error == asio::error::operation_aborted) return {ReadStatus::timeout};
    throw files::IoError(text_of(endpoint()) + ": cannot be read: " + done.error.message());
  }

  void stop() override { loop_.stop(); }

  [[nodiscard]] std::string name() const override { return "udp " + text_of(endpoint()); }

private:
  [[nodiscard]] Endpoint endpoint() const {
    const auto local = socket_.local_endpoint();
    return {local.address().to_string(), local.port()};
  }

  std::optional<asio::ip::address_v6::bytes_type> from_;
  StoppableLoop loop_;
  asio::ip::udp::socket socket_;
};

}  // namespace

std::unique_ptr<ByteSource> open_udp_listener(const Endpoint& endpoint,
                                              const std::optional<std::string>& from) {
  return std::make_unique<UdpListener>(endpoint, from);
}

}  // namespace sonopose::transport
