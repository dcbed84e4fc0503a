#include "bridge/packet_events.hpp"

#include "marvelmind/conversions.hpp"

#include <variant>

namespace sonopose::bridge {

void report(const marvelmind::Assembler& assembler, const marvelmind::DecoderCounters& line,
            publication::SampleSink& sink, const StepFreeClock* clock) {
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

void pass_on(Event event, ImuMeaning imu_meaning, publication::SampleSink& sink) {
  if (auto* imu = std::get_if<ImuSample>(&event)) imu->meaning = imu_meaning;
  sink.on(event);
}

void pass_on_map(const marvelmind::Packet& packet, TimeNs received_ns, publication::SampleSink& sink) {
  const auto* const map = std::get_if<marvelmind::StationaryBeacons>(&packet);
  if (map == nullptr) return;
  for (const marvelmind::StationaryBeacon& beacon : map->beacons()) {
    sink.on_stationary(marvelmind::to_stationary_beacon(beacon, received_ns));
  }
}

}  // namespace sonopose::bridge
