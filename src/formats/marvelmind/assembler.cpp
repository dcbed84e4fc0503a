#include "marvelmind/assembler.hpp"

#include <algorithm>

namespace sonopose::marvelmind {

void Assembler::on(const Packet& packet, TimeNs arrival_ns, EventSink sink) {
  flush(arrival_ns, sink);
  if (const auto* imu = std::get_if<RawImu>(&packet)) {
    beacon_of(imu->address).on(*imu, arrival_ns, sink);
  } else if (const auto* position = std::get_if<Position>(&packet)) {
    beacon_of(position->address).on(*position, arrival_ns, sink);
  } else if (const auto* quality = std::get_if<Quality>(&packet)) {
    beacon_of(quality->address).on(*quality, arrival_ns, sink);
  } else if (const auto* telemetry = std::get_if<Telemetry>(&packet)) {
    beacon_of(telemetry->address).on(*telemetry);
  }
}

void Assembler::flush(TimeNs now_ns, EventSink sink) {
  for (BeaconAssembler* beacon : in_order_) beacon->flush(now_ns, sink);
}

void Assembler::finish(EventSink sink) {
  for (BeaconAssembler* beacon : in_order_) beacon->finish(sink);
}

void Assembler::forget(std::uint8_t address) {
  std::erase(in_order_, by_address_[address].get());
  by_address_[address].reset();
}

std::optional<TimeNs> Assembler::next_deadline_ns() const {
  std::optional<TimeNs> earliest;
  for (const BeaconAssembler* beacon : in_order_) {
    if (const auto due = beacon->next_deadline_ns()) earliest = std::min(earliest.value_or(*due), *due);
  }
  return earliest;
}

TimeNs Assembler::replay_arrival_ns(const Packet& packet, TimeNs origin_ns) {
  TimeNs reached_ns = replay_reached_ns_.value_or(origin_ns);
  if (const auto sent = content_time(packet)) {
    const auto sent_ns = beacon_of(address_of(packet).value_or(0)).sent_host_ns(*sent, reached_ns);
    reached_ns = std::max(reached_ns, sent_ns.value_or(reached_ns));
  }
  replay_reached_ns_ = reached_ns;
  return reached_ns;
}

std::vector<BeaconAddress> Assembler::addresses() const {
  std::vector<BeaconAddress> addresses;
  addresses.reserve(in_order_.size());
  for (const BeaconAssembler* beacon : in_order_) addresses.push_back(beacon->address());
  return addresses;
}

const BeaconAssembler* Assembler::beacon(BeaconAddress address) const {
  return address < by_address_.size() ? by_address_[address].get() : nullptr;
}

BeaconAssembler& Assembler::beacon_of(std::uint8_t address) {
  auto& beacon = by_address_[address];
  if (!beacon) {
    beacon = std::make_unique<BeaconAssembler>(address, mapping_);
    in_order_.push_back(beacon.get());
  }
  return *beacon;
}

}  // namespace sonopose::marvelmind
