#include "bridge/bridge_publisher.hpp"

#include "process/clocks.hpp"
#include <sonopose/dds/topics/conversions.hpp>

namespace sonopose::bridge {
namespace {

namespace topics = dds::topics;

/// Live, a fusion that has stopped holds nobody up.
dds::DomainOptions domain_options(const BridgeOptions& options) {
  dds::DomainOptions domain = options.domain;
  domain.wait_for_readers = options.lossless;
  domain.batch_writes = options.batch;
  return domain;
}

}  // namespace

BridgeNode::Publisher::Publisher(const BridgeOptions& options, const process::StopSignal* stop)
    : lossless_(options.lossless),
      batch_(options.batch),
      stop_(stop),
      participant_(domain_options(options)),
      qos_(options.qos_file),
      others_(participant_, qos_),
      status_last_(process::steady_now()) {
  const auto delivery = lossless_ ? dds::Delivery::lossless : dds::Delivery::live;
  imu_writer_ = dds::make_writer(participant_, qos_, topics::imu, &imu_listener_, delivery);
  fix_writer_ = dds::make_writer(participant_, qos_, topics::fix, &fix_listener_, delivery);
  heading_writer_ = dds::make_writer(participant_, qos_, topics::heading, &heading_listener_, delivery);
  truth_writer_ = dds::make_writer(participant_, qos_, topics::truth);
  status_writer_ = dds::make_writer(participant_, qos_, topics::beacon_status);
  if (options.record_folder) recorder_.emplace(*options.record_folder);
}

BridgeNode::Publisher::~Publisher() {
  // Readers' deadlines end with the instances: a bridge that left is no bridge that is late. (Lossless
  // writers would wait for room first: there the writers' own end must tell.)
  const auto unregister = [this]<class T>(dds::DataWriter<T>& writer) {
    for (const auto& entry : beacons_) {
      T key{};
      key.address = entry.first;
      writer.try_unregister_instance(key);
    }
  };
  if (!lossless_) {
    unregister(imu_writer_);
    unregister(fix_writer_);
    unregister(heading_writer_);
  }
  unregister(truth_writer_);
  unregister(status_writer_);
}

BridgeNode::Publisher::Beacon& BridgeNode::Publisher::beacon_of(BeaconAddress address) {
  Beacon& beacon = beacons_.try_emplace(address, *this).first->second;
  beacon.status.address = address;
  return beacon;
}

void BridgeNode::Publisher::on(const Event& event) {
  Beacon& beacon = beacon_of(address_of(event));
  Event numbered = event;
  std::visit(
      [&beacon](auto& sample) {
        if (sample.sequence == 0) sample.sequence = beacon.next_sequence;
        beacon.next_sequence = sample.sequence + 1;
      },
      numbered);
  std::visit([&](const auto& sample) { publish(sample, beacon); }, numbered);
  if (recorder_) recorder_->write(numbered);
}

BridgeNode::Publisher::Stream::Stream(const dds::Entity& writer)
    : deadlines(dds::deadline_of(writer.qos()).count()) {}

void BridgeNode::Publisher::Stream::note() {
  ++samples;
  deadlines.on_sample(process::steady_now());
}

void BridgeNode::Publisher::publish(ImuSample imu, Beacon& beacon) {
  beacon.imu.note();
  imu.bridge_time_ns = process::host_now();
  write(imu_writer_, dds::to_idl(imu));
}

void BridgeNode::Publisher::publish(const UltrasonicFix& fix, Beacon& beacon) {
  beacon.fix.note();
  write(fix_writer_, dds::to_idl(fix));
}

void BridgeNode::Publisher::publish(const PairHeading& heading, Beacon& beacon) {
  beacon.heading.note();
  write(heading_writer_, dds::to_idl(heading));
}

void BridgeNode::Publisher::on(const TruthSample& truth) {
  beacon_of(truth.address);
  write(truth_writer_, dds::to_idl(truth));
  if (recorder_) recorder_->write(truth);
}

void BridgeNode::Publisher::on(const BeaconStatus& status) {
  beacon_of(status.address).status = status;
}

void BridgeNode::Publisher::flush() {
  if (!batch_) return;
  imu_writer_.flush();
  fix_writer_.flush();
  heading_writer_.flush();
  truth_writer_.flush();
  status_writer_.flush();
}

}  // namespace sonopose::bridge
