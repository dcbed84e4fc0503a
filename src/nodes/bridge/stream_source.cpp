#include "bridge/beacon_clock_log.hpp"
#include "bridge/byte_sources.hpp"
#include "bridge/pacer.hpp"
#include "bridge/packet_events.hpp"
#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/log.hpp"
#include "marvelmind/assembler.hpp"
#include "marvelmind/decoder.hpp"
#include "marvelmind/foreign_protocol.hpp"
#include "transport/byte_file.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sonopose::bridge {
namespace {

using transport::ReadStatus;

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
  marvelmind::Assembler assembler_{marvelmind::TimeMapping::fixed};
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

}  // namespace sonopose::bridge
