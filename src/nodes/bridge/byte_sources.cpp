#include "bridge/byte_sources.hpp"

#include "bridge/address_owners.hpp"
#include "bridge/beacon_clock_log.hpp"
#include "bridge/capture.hpp"
#include "bridge/line_beacons.hpp"
#include "bridge/line_fault_detector.hpp"
#include "bridge/pacer.hpp"
#include "bridge/shifted.hpp"
#include "bridge/step_free_clock.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "marvelmind/assembler.hpp"
#include "marvelmind/conversions.hpp"
#include "marvelmind/decoder.hpp"
#include "marvelmind/foreign_protocol.hpp"
#include "process/free_memory.hpp"
#include "transport/byte_file.hpp"
#include "transport/serial_port.hpp"
#include "transport/udp_listener.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sonopose::bridge {
namespace {

using marvelmind::Assembler;
using transport::ReadStatus;

/// Buffer larger than any frame or datagram.
using Buffer = std::array<std::uint8_t, 4096>;

/// Reports the counters of assembler and decoder for each beacon. `clock`: clock of the arrivals, if the
/// host's clock can be set meanwhile.
void report(const Assembler& assembler, const marvelmind::DecoderCounters& line,
            publication::SampleSink& sink, const StepFreeClock* clock = nullptr) {
  for (const BeaconAddress address : assembler.addresses()) {
    BeaconStatus status = assembler.beacon(address)->status();
    if (clock != nullptr) {
      status.clock_offset_s += seconds_between(0, clock->host_ahead_ns());
      status.clock_resets += clock->steps();
    }
    status.frames = line.frames;
    status.crc_errors = line.crc_errors;
    status.bytes_lost = line.bytes_lost;
    status.unknown_frames = line.unknown_frames + line.malformed_frames;
    sink.on(status);
  }
}

/// Passes an event on. IMU samples get the meaning that the user declares.
void pass_on(Event event, ImuMeaning imu_meaning, publication::SampleSink& sink) {
  if (auto* imu = std::get_if<ImuSample>(&event)) imu->meaning = imu_meaning;
  sink.on(event);
}

/// Passes on the stationary beacons of a map packet; ignores other packets.
void pass_on_map(const marvelmind::Packet& packet, TimeNs received_ns, publication::SampleSink& sink) {
  const auto* const map = std::get_if<marvelmind::StationaryBeacons>(&packet);
  if (map == nullptr) return;
  for (const marvelmind::StationaryBeacon& beacon : map->beacons()) {
    sink.on_stationary(marvelmind::to_stationary_beacon(beacon, received_ns));
  }
}

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
    if (!address || (owners_.accepts(*address, sender, now) && beacons_.accepts(*address, now))) return true;
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
  Assembler assembler_{marvelmind::TimeMapping::fitted};
  BeaconClockLog clock_log_{marvelmind::TimeMapping::fitted};
  process::FreeMemory free_memory_;
  StepFreeClock clock_{clocks::host_now(), clocks::steady_now()};
  std::uint64_t bytes_received_ = 0;
  std::uint64_t packets_refused_ = 0;
  bool said_unused_ = false;
};

constexpr const char* protocol_setting =
    "the protocol of the beacon's UART and USB output to Marvelmind (Dashboard, Interfaces)";

/// Throws an error that names what a file without valid frames has instead. `begin`: its first bytes.
[[noreturn]] void refuse_foreign(const std::filesystem::path& path, std::uint64_t size,
                                 const marvelmind::DecoderCounters& counters,
                                 std::span<const std::uint8_t> begin) {
  if (size == 0) throw files::IoError(path.string() + ": is empty");
  const std::string foreign = marvelmind::foreign_protocol(begin);
  constexpr std::uint64_t min_damaged = 3;  // noise has false starts
  if (foreign.empty() && counters.unknown_frames > 0) {
    throw files::IoError(fmt::format(
        "{}: {}, which are not used: enable the streams of raw IMU and positions", path.string(),
        text::count_text(counters.unknown_frames, "frame of another kind", "frames of other kinds")));
  }
  if (foreign.empty() && counters.crc_errors >= min_damaged &&
      counters.crc_errors * marvelmind::max_frame_size >= size) {
    throw files::IoError(
        fmt::format("{}: {} with a wrong checksum, and none with a right one: the file is damaged, as by a "
                    "transfer as text",
                    path.string(), text::count_text(counters.crc_errors, "frame")));
  }
  throw files::IoError(fmt::format(
      "{}: {}; --source stream plays raw bytes of a beacon: set {}. Recordings are for --source log or mcap",
      path.string(), foreign.empty() ? text::count_text(size, "byte") + " without a valid frame" : foreign,
      protocol_setting));
}

/// Throws if the file has no valid frame.
void check_has_frames(const std::filesystem::path& path) {
  transport::ByteFile file(path);
  marvelmind::Decoder decoder;
  const auto ignore = [](const marvelmind::Packet&) {};
  std::vector<std::uint8_t> begin;
  std::uint64_t size = 0;
  Buffer buffer;
  while (decoder.counters().frames == 0) {
    const transport::ReadResult read = file.read(buffer, std::chrono::milliseconds(0));
    if (read.status != ReadStatus::data) break;
    const auto got = std::span(buffer).first(read.size);
    if (size == 0) begin.assign(got.begin(), got.end());
    size += read.size;
    decoder.feed(got, ignore);
  }
  decoder.finish(ignore);
  if (decoder.counters().frames == 0) refuse_foreign(path, size, decoder.counters(), begin);
}

/// A file of bytes, timed by the beacons' own clock.
class StreamSource final : public publication::Source {
public:
  explicit StreamSource(const StreamOptions& options)
      : options_(options), file_(options.file), pacer_(options.rate) {
    // A pipe can be read only once.
    if (std::filesystem::is_regular_file(options.file)) check_has_frames(options.file);
  }

  [[nodiscard]] bool is_recording() const override { return true; }

  void run(publication::SampleSink& sink, const process::StopSignal& stop) override {
    const TimeNs origin_ns = clocks::host_now();
    bool stopped = false;
    // Samples after a step of the beacon's clock are kept until it shows whether that was a pause.
    const auto publish = [&](const Event& event) {
      stopped = stopped || !pacer_.wait_for(available_at_ns(event), sink, stop);
      if (stopped) return;
      ++events_;
      pass_on(event, options_.imu_meaning, sink);
    };
    // Publish a sample when its packet was sent, not when it was read from the file.
    const auto play = [&](const marvelmind::Packet& packet) {
      if (stopped) return;
      check_address(packet);
      const TimeNs arrival_ns = assembler_.replay_arrival_ns(packet, origin_ns);
      stopped = !pacer_.wait_for(arrival_ns, sink, stop);
      if (stopped) return;
      pass_on_map(packet, arrival_ns, sink);
      assembler_.on(packet, arrival_ns, publish);
      report_sometimes(sink);
    };
    Buffer buffer;
    while (!stopped && !stop.requested()) {
      const transport::ReadResult read = file_.read(buffer, std::chrono::milliseconds(0));
      if (read.status != ReadStatus::data) break;
      const auto got = std::span(buffer).first(read.size);
      if (bytes_read_ == 0) begin_.assign(got.begin(), got.end());
      bytes_read_ += read.size;
      const std::uint64_t lost_before = decoder_.counters().bytes_lost;
      decoder_.feed(got, play);
      if (foreign_.empty() && decoder_.counters().bytes_lost > lost_before) {
        foreign_ = marvelmind::foreign_protocol(got);
      }
    }
    decoder_.finish(play);
    if (!stopped) assembler_.finish(publish);
    report_beacons(sink);
    if (!stopped && !stop.requested()) report_unused();
  }

private:
  /// Reports what was not played. Throws if that is everything, or much.
  void report_unused() const {
    const marvelmind::DecoderCounters& counters = decoder_.counters();
    if (counters.frames == 0) refuse_foreign(options_.file, bytes_read_, counters, begin_);
    for (const BeaconAddress address : assembler_.addresses()) {
      const marvelmind::BeaconAssembler& beacon = *assembler_.beacon(address);
      const auto text = stamps_too_late_text(beacon);
      if (!text) continue;
      const std::string line = fmt::format("{}: {}", options_.file.string(), *text);
      constexpr std::uint64_t max_share = 10;  // a tenth; a few may be damaged
      if (max_share * beacon.counters().stamps_too_late > events_) throw files::IoError(line);
      logging::warning(line);
    }
    if (events_ == 0) {
      throw files::IoError(
          fmt::format("{}: {}, but no sample: enable the streams of raw IMU and positions of the beacon",
                      options_.file.string(), text::count_text(counters.frames, "valid frame")));
    }
    if (counters.unused_frames > 0) {
      logging::info(fmt::format("{}: ignored {} of unused kinds, such as {}", options_.file.string(),
                                text::count_text(counters.unused_frames, "frame"), counters.first_unused));
    }
    const std::uint64_t other_frames = counters.unknown_frames + counters.malformed_frames;
    if (counters.bytes_lost == 0 && other_frames == 0) return;
    logging::warning(fmt::format(
        "{}: {} of {} bytes are in no valid frame ({}), {} of no known kind{}", options_.file.string(),
        counters.bytes_lost, bytes_read_, text::count_text(counters.crc_errors, "wrong checksum"),
        text::count_text(other_frames, "frame"),
        foreign_.empty() ? "" : fmt::format("; found {}: set {}", foreign_, protocol_setting)));
  }

  /// Throws for a beacon beyond the limit: a recording must not lose samples silently.
  void check_address(const marvelmind::Packet& packet) {
    const auto address = marvelmind::address_of(packet);
    if (!address || admission_.accepts(*address)) return;
    throw files::IoError(fmt::format("{}: beacon {} is one more than --max-beacons {}",
                                     options_.file.string(), *address, options_.max_beacons));
  }

  void report_sometimes(publication::SampleSink& sink) {
    constexpr std::uint64_t packets = 64;
    if (++played_ % packets == 0) report_beacons(sink);
  }

  void report_beacons(publication::SampleSink& sink) {
    report(assembler_, decoder_.counters(), sink);
    for (const std::string& line : clock_log_.update(assembler_)) logging::warning(line);
  }

  StreamOptions options_;
  presence::BeaconAdmission admission_{{}, options_.max_beacons};
  transport::ByteFile file_;
  Pacer pacer_;
  marvelmind::Decoder decoder_;
  Assembler assembler_{marvelmind::TimeMapping::fixed};
  BeaconClockLog clock_log_{marvelmind::TimeMapping::fixed};
  std::uint64_t played_ = 0;
  std::vector<std::uint8_t> begin_;  ///< first bytes of the file
  std::string foreign_;              ///< name of what is between valid frames, if known
  std::uint64_t bytes_read_ = 0;
  std::uint64_t events_ = 0;
};

}  // namespace

std::unique_ptr<publication::Source> make_stream_source(const StreamOptions& options) {
  return std::make_unique<StreamSource>(options);
}

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
