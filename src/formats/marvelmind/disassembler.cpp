#include "marvelmind/disassembler.hpp"

#include "marvelmind/conversions.hpp"

namespace sonopose::marvelmind {

namespace {

std::int64_t divide_down(std::int64_t value, std::int64_t divisor) {
  return value / divisor - (value % divisor < 0 ? 1 : 0);
}

}  // namespace

void Disassembler::on(const Event& event, PacketSink sink) {
  if (std::holds_alternative<TwistSample>(event)) return;  // no packet has it
  if (const auto* heading = std::get_if<PairHeading>(&event)) {
    if (!waiting_ || heading->emission_time_ns != waiting_->emission_time_ns) return;
    send(*waiting_, heading, sink);
    waiting_.reset();
    return;
  }
  flush(sink);
  if (const auto* imu = std::get_if<ImuSample>(&event)) {
    sink(to_raw_imu(*imu, stamp_of(imu->sensor_time_ns)));
  } else {
    waiting_ = std::get<UltrasonicFix>(event);
  }
}

void Disassembler::flush(PacketSink sink) {
  if (waiting_) send(*waiting_, nullptr, sink);
  waiting_.reset();
}

void Disassembler::send(const UltrasonicFix& fix, const PairHeading* heading, PacketSink sink) const {
  Stamp stamp = stamp_of(fix.emission_time_ns);
  if ((fix.flags & ultrasonic_flag_second_resolution) != 0 && stamp.base == TimeBase::uptime_ms) {
    stamp = {TimeBase::uptime_64ths, static_cast<std::uint32_t>(divide_down(
                                         fix.emission_time_ns - options_.beacon_zero_ns, ns_per_64th))};
  }
  sink(to_position(fix, heading, stamp));
  if (const auto quality = to_quality(fix)) sink(*quality);
}

Stamp Disassembler::stamp_of(TimeNs time_ns) const {
  const std::int64_t beacon_ns = time_ns - options_.beacon_zero_ns;
  const std::int64_t ticks =
      divide_down(beacon_ns, options_.time_base == TimeBase::uptime_64ths ? ns_per_64th : ns_per_ms);
  if (options_.time_base == TimeBase::unix_ms) return {TimeBase::unix_ms, ticks};
  return {options_.time_base, static_cast<std::uint32_t>(ticks)};
}

}  // namespace sonopose::marvelmind
