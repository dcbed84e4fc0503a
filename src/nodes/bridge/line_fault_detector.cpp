#include "bridge/line_fault_detector.hpp"

#include "marvelmind/foreign_protocol.hpp"
#include "marvelmind/packet.hpp"
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace sonopose::bridge {
namespace {

/// Longest silence of a working line; beacons send several times a second. LineStatus documents this value.
constexpr TimeNs silence_limit_ns = 3'000'000'000;

}  // namespace

void LineFaultDetector::on_bytes(std::span<const std::uint8_t> bytes) {
  bytes = bytes.last(std::min(bytes.size(), latest_.size()));
  const std::size_t kept = std::min(latest_size_, latest_.size() - bytes.size());
  const auto to_drop = static_cast<std::ptrdiff_t>(latest_size_ - kept);
  std::shift_left(latest_.begin(), latest_.begin() + static_cast<std::ptrdiff_t>(latest_size_), to_drop);
  std::copy(bytes.begin(), bytes.end(), latest_.begin() + static_cast<std::ptrdiff_t>(kept));
  latest_size_ = kept + bytes.size();
}

std::string LineFaultDetector::advice() const {
  const std::string foreign = marvelmind::foreign_protocol(std::span(latest_).first(latest_size_));
  return foreign.empty() ? advice_.unknown : fmt::format("they are {}; {}", foreign, advice_.foreign);
}

void LineFaultDetector::judge(LineStatus& line, SteadyTime now) {
  const bool was_open = std::exchange(is_open_, line.state == LineState::open);
  if (!was_open || !is_open_) begin(now);
  if (line.bytes != bytes_.count) bytes_ = {line.bytes, now};
  if (line.frames != frames_.count) {
    frames_ = {line.frames, now};
    bytes_at_frame_ = line.bytes;
  }
  log_.update(now);
  if (!is_open_) return;
  const std::uint64_t bytes_without_frame = line.bytes - bytes_at_frame_;
  // An incomplete frame at the end of a transmission is no sign of a wrong baud rate.
  if (now - frames_.since >= silence_limit_ns && bytes_without_frame > marvelmind::max_frame_size) {
    line.state = LineState::no_frames;
    line.text =
        fmt::format("{} without a valid frame: {}", text::count_text(bytes_without_frame, "byte"), advice());
  } else if (now - bytes_.since >= silence_limit_ns) {
    line.state = LineState::silent;
    line.text = fmt::format("no bytes for {:.0f} s: check that the beacon is on and streams its data",
                            seconds_between(bytes_.since, now));
  }
  log_change(line, now);
}

/// Restarts both silences. Bytes since the previous call count: the line was open already.
void LineFaultDetector::begin(SteadyTime now) {
  bytes_.since = now;
  frames_.since = now;
  bytes_at_frame_ = bytes_.count;
  if (!is_open_) latest_size_ = 0;
  logged_ = LineState::open;
}

void LineFaultDetector::log_change(const LineStatus& line, SteadyTime now) {
  if (std::exchange(logged_, line.state) == line.state) return;
  const bool is_good = line.text.empty();
  log_.write(is_good ? logging::Level::info : logging::Level::warning,
             fmt::format("{}: {}", line.name, is_good ? "valid frames arrive" : line.text), now);
}

}  // namespace sonopose::bridge
