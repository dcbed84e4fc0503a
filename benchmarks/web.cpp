// Compares the processor time of the live page's server, which has one viewer, with that of a consumer that
// only counts the same topics, with many beacons.

#include "clocks/clocks.hpp"
#include "counting_consumer.hpp"
#include "support/upgrade_request.hpp"

#include <fmt/format.h>

#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <cstdint>
#include <netinet/in.h>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;

/// Reads a page's messages in a thread, and counts their bytes.
class Viewer {
public:
  /// Throws std::runtime_error if the server does not answer.
  explicit Viewer(std::uint16_t port) : socket_(connected(port)) {
    send(test::upgrade_request("/ws", "sonopose.v1", fmt::format("Host: 127.0.0.1:{}\r\n", port)));
    reader_ = std::thread([this] { read(); });
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer() {
    is_ending_ = true;
    reader_.join();
    ::close(socket_);
  }

  /// Throws std::runtime_error if the server has closed the connection.
  [[nodiscard]] std::int64_t bytes() const {
    if (!is_connected_) throw std::runtime_error("sonopose-web closed the connection");
    return bytes_;
  }

private:
  static int connected(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (int attempt = 0; attempt < 100; ++attempt) {
      const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
      if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return socket;
      ::close(socket);
      sleep_s(0.1);
    }
    throw std::runtime_error(fmt::format("sonopose-web does not answer on port {}", port));
  }

  void send(const std::string& text) const {
    if (::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) < 0) throw std::runtime_error("send failed");
  }

  void read() {
    // An empty pong: the client is alive.
    const std::string pong{'\x8a', '\x80', '\0', '\0', '\0', '\0'};
    std::array<char, 65536> buffer{};
    SteadyTime pong_due = clocks::steady_now();
    while (!is_ending_) {
      pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
      if (::poll(&waiting, 1, 50) > 0) {
        const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), 0);
        if (count <= 0) break;
        bytes_ += count;
      }
      if (clocks::steady_now() < pong_due) continue;
      pong_due = clocks::steady_now() + 5'000'000'000;
      ::send(socket_, pong.data(), pong.size(), MSG_NOSIGNAL);
    }
    is_connected_ = false;
  }

  int socket_;
  std::atomic<std::int64_t> bytes_ = 0;
  std::atomic<bool> is_connected_ = true;
  std::atomic<bool> is_ending_ = false;
  std::thread reader_;
};

}  // namespace

int main(int argc, char** argv) {
  ComparisonOptions options;
  std::uint16_t port = 48080;
  CLI::App app("The processor time of the live page's server, next to a consumer that only counts.",
               "benchmark_web");
  add_options(app, options);
  app.add_option("--port", port, "Port of the page")->capture_default_str();
  return run_main(app, argc, argv, [&] {
    const CountedChain chain(options);
    const Child web = Child::execute({SONOPOSE_WEB, "--domain", std::to_string(options.domain), "--listen",
                                      fmt::format("127.0.0.1:{}", port)});
    const Viewer viewer(port);
    chain.compare(web.pid(), "one viewer", [&] { return viewer.bytes(); });
  });
}
