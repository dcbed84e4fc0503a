#include "monitor/echo/echo.hpp"

#include "clocks/clocks.hpp"
#include "json/json.hpp"
#include "logging/log.hpp"
#include "monitor/echo/line_output.hpp"
#include "process/endpoint_counters.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <algorithm>
#include <csignal>
#include <stdexcept>
#include <tuple>
#include <unistd.h>

namespace sonopose::monitor::echo {
namespace {

namespace topics = dds::topics;

/// Accepts the samples of one beacon.
class OneBeacon final : public topics::AddressFilter {
public:
  explicit OneBeacon(BeaconAddress address) : address_(address) {}
  bool accepts(BeaconAddress address) noexcept override { return address == address_; }

private:
  BeaconAddress address_;
};

/// Wakes the printing thread: the receive thread must not wait for a pipe.
template <class T>
class WakingListener final : public process::CountingReaderListener<T> {
public:
  WakingListener(process::Wakeup& wakeup, process::EndpointCounters& endpoints)
      : process::CountingReaderListener<T>(endpoints), wakeup_(wakeup) {}
  void on_data_available(dds::sub::DataReader<T>& /*reader*/) noexcept override { wakeup_.wake(); }

private:
  process::Wakeup& wakeup_;
};

/// Reports once that a writer does not match.
void report_incompatible(const process::EndpointCounters& endpoints, bool& reported) {
  if (reported || endpoints.incompatible_qos == 0) return;
  reported = true;
  logging::warning("a writer offers incompatible QoS; run sonopose-doctor for details");
}

/// Lines of the samples of one batch, up to the count.
class Lines {
public:
  explicit Lines(std::uint64_t count) : max_(count) {}

  template <class T>
  void add(const T& sample) {
    if (is_complete()) return;
    json::append_json(text_, sample);
    text_ += '\n';
    ++added_;
  }

  [[nodiscard]] bool is_complete() const { return max_ > 0 && added_ >= max_; }
  [[nodiscard]] std::uint64_t added() const { return added_; }

  bool write_to(LineOutput& output) {
    const bool good = output.write(text_);
    text_.clear();
    return good;
  }

private:
  std::uint64_t max_;
  std::uint64_t added_ = 0;
  std::string text_;
};

template <class T>
bool echo_topic(const topics::Entry<T>& entry, const EchoOptions& options, const process::StopSignal& stop) {
  constexpr bool has_beacons = requires(const T& sample) {
    sample.address;
  };
  if (options.beacon && !has_beacons) {
    throw std::invalid_argument("--beacon: the samples of " + options.topic + " do not belong to a beacon");
  }
  const dds::qos::Provider qos(options.qos_file);
  const auto participant = dds::ext::participant(options.domain);
  process::Wakeup wakeup;
  process::EndpointCounters endpoints;
  WakingListener<T> listener(wakeup, endpoints);
  OneBeacon filter(options.beacon.value_or(0));
  auto reader = topics::make_reader(participant, qos, entry, &listener, topics::Delivery::live,
                                    options.beacon ? &filter : nullptr);
  const SteadyTime end =
      options.duration_s > 0 ? clocks::steady_now() + to_ns(options.duration_s) : SteadyTime::max();
  constexpr TimeNs check_period_ns = 200'000'000;
  LineOutput output(STDOUT_FILENO, stop);
  Lines lines(options.count);
  bool reported = false;
  while (true) {
    dds::ext::take_each(reader,
                        [&lines](const T& sample, const dds::sub::SampleInfo&) { lines.add(sample); });
    if (!lines.write_to(output) || lines.is_complete() || output.is_closed()) return true;
    report_incompatible(endpoints, reported);
    const SteadyTime now = clocks::steady_now();
    if (now >= end) return lines.added() > 0;
    if (stop.wait_until(std::min(end, now + check_period_ns), wakeup)) return true;
  }
}

}  // namespace

bool echo(const EchoOptions& options, const process::StopSignal& stop) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is the end of the output, not a crash
  const std::string topic = topics::short_name(options.topic);
  bool good = false;
  const auto try_one = [&](const auto& entry) {
    if (topics::short_name(entry.name) != topic) return false;
    good = echo_topic(entry, options, stop);
    return true;
  };
  const bool found =
      std::apply([&](const auto&... entries) { return (try_one(entries) || ...); }, topics::all);
  if (!found) throw std::invalid_argument(options.topic + ": unknown topic");
  return good;
}

}  // namespace sonopose::monitor::echo
