#include "bridge/address_owners.hpp"
#include "bridge/beacon_clock_log.hpp"
#include "bridge/byte_sources.hpp"
#include "bridge/capture.hpp"
#include "bridge/line_beacons.hpp"
#include "bridge/line_fault_detector.hpp"
#include "bridge/packet_events.hpp"
#include "bridge/shifted.hpp"
#include "bridge/step_free_clock.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "marvelmind/assembler.hpp"
#include "marvelmind/decoder.hpp"
#include "process/free_memory.hpp"
#include "transport/serial_port.hpp"
#include "transport/udp_listener.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace sonopose::bridge {
namespace {

using transport::ReadStatus;

/// A live line. `Decoder` finds the packets; the assembler turns them into samples by arrival time.
template <class Decoder>
class LiveSource final : public publication::Source {
public:
  LiveSource(std::unique_ptr<transport::ByteSource> bytes, LineFaultDetector detector,
             const LiveOptions& options)
      : imu_meaning_(options.imu_meaning),
        bytes_(std::move(bytes)),
        detector_(std::move(detector)),
        beacons_(options.max_beacons) {
    if (options.capture) capture_.emplace(*options.capture, publication::FullQueuePolicy::lose);
  }

  void run(publication::SampleSink& sink, const process::StopSignal& stop) override {
    const auto publish = [this, &sink](const Event& event) {
      pass_on(shifted(event, clock_.host_ahead_ns()), imu_meaning_, sink);
    };
    if (capture_) capture_->obey(stop);
    Buffer buffer;
    report_line(sink);
    SteadyTime reported = clocks::steady_now();
    while (!stop.requested()) {
      const transport::ReadResult read = read_from_line(buffer, sink);
      const SteadyTime now = compare_clocks();
      if (read.status == ReadStatus::data) {
        const auto got = std::span(buffer).first(read.size);
        bytes_received_ += read.size;
        decoder_.feed(got, [&](const marvelmind::Packet& packet) {
          if (!accepts(packet, read.sender)) return;
          const TimeNs arrival_ns = clock_.at(read.arrival);
          pass_on_map(packet, saturated_sum(arrival_ns, clock_.host_ahead_ns()), sink);
          assembler_.on(packet, arrival_ns, publish);
        });
        detector_.on_bytes(got);
        if (capture_) capture_->append(got);
      } else if (read.status == ReadStatus::end || read.status == ReadStatus::stopped) {
        break;
      } else if (read.status == ReadStatus::refused) {
        ++packets_refused_;
      } else {
        log_change(read.status);
      }
      assembler_.flush(clock_.at(now), publish);
      if (now - reported < report_period_ns) continue;
      reported = now;
      remove_gone(sink);
      report(assembler_, decoder_.counters(), sink, &clock_);
      for (const std::string& line : clock_log_.update(assembler_)) {
        detector_.log().write(logging::Level::warning, line, now);
      }
      report_line(sink);
      sink.tick();
    }
    report_line(sink);
    detector_.log().finish();
  }

  void finish() override {
    if (capture_) capture_->finish();
  }

private:
  static constexpr TimeNs report_period_ns = 200'000'000;

  /// Time until a packet has waited long enough or the stop signal must be checked.
  [[nodiscard]] std::chrono::milliseconds timeout() const {
    constexpr std::int64_t max_wait_ms = 100;
    const auto deadline_ns = assembler_.next_deadline_ns();
    if (!deadline_ns) return std::chrono::milliseconds(max_wait_ms);
    constexpr TimeNs ms = 1'000'000;
    return std::chrono::milliseconds(
        std::clamp<std::int64_t>((*deadline_ns - clock_.at(clocks::steady_now())) / ms + 1, 1, max_wait_ms));
  }

  /// Compares the line's clock with the host's. Returns the steady time.
  SteadyTime compare_clocks() {
    const SteadyTime before = clocks::steady_now();
    const HostTime host_ns = clocks::host_now();
    const SteadyTime after = clocks::steady_now();
    clock_.compare(before, host_ns, after);
    return after;
  }

  bool accepts(const marvelmind::Packet& packet, const transport::Sender& sender) {
    const auto address = marvelmind::address_of(packet);
    const SteadyTime now = clocks::steady_now();
    if (owners_.accepts(address, sender, now) && (!address || beacons_.accepts(*address, now))) return true;
    ++packets_refused_;
    return false;
  }

  void remove_gone(publication::SampleSink& sink) {
    const SteadyTime now = clocks::steady_now();
    for (const std::uint8_t address : beacons_.remove_gone(now)) {
      assembler_.forget(address);
      free_memory_.on_freed();
      sink.on_gone(address);
    }
    free_memory_.give_back(now);
    if (const auto text = beacons_.refusals()) logging::warning(*text);
  }

  /// Reads from the line. A failure is visible on the bus before the bridge ends.
  transport::ReadResult read_from_line(Buffer& buffer, publication::SampleSink& sink) {
    try {
      return bytes_->read(buffer, timeout());
    } catch (const std::exception& error) {
      LineStatus status = line_status();
      status.state = LineState::failed;
      status.text = error.what();
      sink.on(status);
      throw;
    }
  }

  void report_line(publication::SampleSink& sink) {
    LineStatus status = line_status();
    const SteadyTime now = clocks::steady_now();
    detector_.judge(status, now);
    sink.on(status);
    if (said_unused_ || decoder_.counters().unused_frames == 0) return;
    said_unused_ = true;
    detector_.log().write(logging::Level::info,
                          fmt::format("{}: ignores frames of unused kinds, such as {}", status.name,
                                      decoder_.counters().first_unused),
                          now);
  }

  [[nodiscard]] LineStatus line_status() const {
    const marvelmind::DecoderCounters& counters = decoder_.counters();
    LineStatus status;
    status.name = bytes_->name();
    status.state = bytes_->state();
    status.bytes = bytes_received_;
    status.frames = counters.frames;
    status.crc_errors = counters.crc_errors;
    status.bytes_lost = counters.bytes_lost;
    status.packets_refused = packets_refused_;
    status.text = bytes_->last_error();
    return status;
  }

  void log_change(ReadStatus status) {
    const SteadyTime now = clocks::steady_now();
    if (status == ReadStatus::connected) {
      detector_.log().write(logging::Level::info, "reading " + bytes_->description(), now);
    }
    if (status == ReadStatus::disconnected) {
      detector_.log().write(logging::Level::warning,
                            fmt::format("waiting for {} ({})", bytes_->description(), bytes_->last_error()),
                            now);
    }
  }

  ImuMeaning imu_meaning_;
  std::unique_ptr<transport::ByteSource> bytes_;
  LineFaultDetector detector_;
  AddressOwners owners_;
  LineBeacons beacons_;
  std::optional<Capture> capture_;
  Decoder decoder_;
  marvelmind::Assembler assembler_{marvelmind::TimeMapping::fitted};
  BeaconClockLog clock_log_{marvelmind::TimeMapping::fitted};
  process::FreeMemory free_memory_;
  StepFreeClock clock_{clocks::host_now(), clocks::steady_now()};
  std::uint64_t bytes_received_ = 0;
  std::uint64_t packets_refused_ = 0;
  bool said_unused_ = false;
};

}  // namespace

std::unique_ptr<publication::Source> make_serial_source(const SerialOptions& options,
                                                        const LiveOptions& live) {
  LineFaultDetector detector(
      {fmt::format("check --baud (now {}), and that the device is a Marvelmind beacon", options.baud),
       fmt::format("set {}, or choose another --device", protocol_setting)});
  auto port = [&options] {
    try {
      return transport::open_serial_port(options.device, options.baud);
    } catch (const files::IoError& error) {
      throw std::invalid_argument(fmt::format("--device: {}", error.what()));
    }
  }();
  return std::make_unique<LiveSource<marvelmind::Decoder>>(std::move(port), std::move(detector), live);
}

std::unique_ptr<publication::Source> make_udp_source(const UdpOptions& options, const LiveOptions& live) {
  LineFaultDetector detector({"check that the sender uses the Marvelmind protocol",
                              "set the protocol of the sender to Marvelmind, or choose another port"});
  return std::make_unique<LiveSource<marvelmind::DatagramDecoder>>(
      transport::open_udp_listener(transport::parse_endpoint(options.listen), options.from),
      std::move(detector), live);
}

}  // namespace sonopose::bridge
