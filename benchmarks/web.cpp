// Compares the processor time of the live page's server, which has one viewer, with that of a consumer that
// only counts the same topics, with many beacons.

#include "child.hpp"
#include "clocks/clocks.hpp"
#include "counting_consumer.hpp"
#include "statistics.hpp"
#include "support/upgrade_request.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <netinet/in.h>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

using namespace sonopose;
using namespace sonopose::benchmarks;

struct Options {
  std::uint32_t domain = 0;
  std::uint32_t beacons = 50;
  double imu_rate_hz = 100;
  std::uint16_t port = 48080;
  double round_s = 10;
  int rounds = 5;
};

void sleep_s(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

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

  [[nodiscard]] std::int64_t bytes() const { return bytes_; }
  [[nodiscard]] bool is_connected() const { return is_connected_; }

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

void measure(const Options& options) {
  const std::string domain = std::to_string(options.domain);
  std::atomic<std::uint64_t>& count = shared_counter();
  const Child counter = Child::fork_to([&] { count_samples(options.domain, count); });
  const Child web = Child::execute(
      {SONOPOSE_WEB, "--domain", domain, "--listen", fmt::format("127.0.0.1:{}", options.port)});
  const Child fusion = Child::execute({SONOPOSE_FUSION, "--domain", domain});
  const Child bridge =
      Child::execute({SONOPOSE_BRIDGE, "--domain", domain, "--beacons", std::to_string(options.beacons),
                      "--imu-rate", fmt::format("{}", options.imu_rate_hz)});
  const Viewer viewer(options.port);
  sleep_s(8.0);  // lets every beacon be found and its fusion settle
  fmt::print("{} beacons at {} Hz, rounds of {} s, one viewer\n", options.beacons, options.imu_rate_hz,
             options.round_s);
  fmt::print("round  samples/s  page CPU  counting consumer CPU  ratio  page kB/s\n");
  std::vector<double> ratios;
  for (int round = 1; round <= options.rounds; ++round) {
    const std::int64_t web_before_ns = web.cpu_time_ns();
    const std::int64_t counter_before_ns = counter.cpu_time_ns();
    const std::int64_t bytes_before = viewer.bytes();
    const std::uint64_t count_before = count;
    const SteadyTime began = clocks::steady_now();
    sleep_s(options.round_s);
    const double web_s = seconds_between(web_before_ns, web.cpu_time_ns());
    const double counter_s = seconds_between(counter_before_ns, counter.cpu_time_ns());
    const double length_s = seconds_between(began, clocks::steady_now());
    if (!viewer.is_connected()) throw std::runtime_error("sonopose-web closed the connection");
    ratios.push_back(web_s / counter_s);
    fmt::print("{:>5} {:>10.0f} {:>7.1f} % {:>20.1f} % {:>6.2f} {:>10.1f}\n", round,
               static_cast<double>(count - count_before) / length_s, 100.0 * web_s / length_s,
               100.0 * counter_s / length_s, ratios.back(),
               1e-3 * static_cast<double>(viewer.bytes() - bytes_before) / length_s);
    std::fflush(stdout);
  }
  fmt::print("median ratio {:.2f}\n", median(ratios));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("The processor time of the live page's server, next to a consumer that only counts.",
               "benchmark_web");
  app.add_option("--domain", options.domain, "DDS domain")->capture_default_str();
  app.add_option("--beacons", options.beacons, "Number of beacons")
      ->check(CLI::Range(1U, 1000U))
      ->capture_default_str();
  app.add_option("--imu-rate", options.imu_rate_hz, "Rate of each beacon's IMU, Hz")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--port", options.port, "Port of the page")->capture_default_str();
  app.add_option("--rounds", options.rounds, "Rounds")->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--seconds", options.round_s, "Length of a round")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    measure(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "benchmark_web: {}\n", error.what());
    return 1;
  }
  return 0;
}
