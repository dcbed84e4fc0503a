#include "other_bridges.hpp"
#include <sonopose/dds/conversions.hpp>
#include <sonopose/dds/participant.hpp>
#include <sonopose/dds/topics.hpp>
#include <sonopose/nodes/beacon_recorder.hpp>
#include <sonopose/nodes/bridge_node.hpp>
#include <sonopose/nodes/deadline_count.hpp>
#include <sonopose/nodes/end_counters.hpp>
#include <sonopose/nodes/host_clock.hpp>

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <utility>

namespace sonopose::nodes {

namespace topics = dds::topics;

namespace {

TimeNs deadline_ns(const dds::Entity& writer) {
  return writer.qos().policy<dds::policy::Deadline>().value_or(dds::policy::Deadline{}).period.count();
}

/// Live, a fusion that has stopped holds nobody up.
dds::DomainOptions domain_options(const BridgeOptions& options) {
  dds::DomainOptions domain = options.domain;
  domain.wait_for_readers = options.lossless;
  domain.batch_writes = options.batch;
  return domain;
}

}  // namespace

class BridgeNode::Publisher final : public SampleSink {
public:
  Publisher(const BridgeOptions& options, const StopSignal* stop = nullptr);
  ~Publisher() override;

  void on(const Event& event) override;
  void on(const TruthSample& truth) override;
  void on(const BeaconStatus& status) override;
  void flush() override;
  void tick() override;

  void obey(const StopSignal& stop) { stop_ = &stop; }
  void publish_statuses(TimeNs now);
  void wait_for_readers();
  void wait_until_read();

private:
  /// One stream of one beacon.
  struct Stream {
    std::uint64_t samples = 0;  ///< of the second that runs
    DeadlineCount deadlines;
  };

  /// What is kept for each address: its numbering, and its status of the second that runs.
  struct Beacon {
    std::uint64_t next_sequence = 1;
    Stream imu;
    Stream fix;
    Stream heading;
    BeaconStatus status;
  };

  Beacon& beacon_of(BeaconAddress address);
  template <class T>
  void write(dds::DataWriter<T>& writer, const T& sample);
  static void note(Stream& stream, TimeNs deadline_ns);
  void publish(ImuSample imu, Beacon& beacon);
  void publish(const UltrasonicFix& fix, Beacon& beacon);
  void publish(const PairHeading& heading, Beacon& beacon);
  void publish_status(Beacon& beacon, TimeNs now_steady_ns);
  void tell_unwritten();
  [[nodiscard]] bool stopped() const { return stop_ != nullptr && stop_->requested(); }

  bool lossless_;
  bool batch_;
  const StopSignal* stop_ = nullptr;
  dds::DomainParticipant participant_;
  dds::QosProvider qos_;
  EndCounters ends_;
  CountingWriterListener<sonopose_ImuSample> imu_listener_{ends_};
  CountingWriterListener<sonopose_UltrasonicFix> fix_listener_{ends_};
  CountingWriterListener<sonopose_PairHeading> heading_listener_{ends_};
  dds::DataWriter<sonopose_ImuSample> imu_writer_;
  dds::DataWriter<sonopose_UltrasonicFix> fix_writer_;
  dds::DataWriter<sonopose_PairHeading> heading_writer_;
  dds::DataWriter<sonopose_TruthSample> truth_writer_;
  dds::DataWriter<sonopose_BeaconStatus> status_writer_;
  OtherBridges others_;
  std::optional<BeaconRecorder> recorder_;
  TimeNs imu_deadline_ns_;
  TimeNs fix_deadline_ns_;
  TimeNs heading_deadline_ns_;
  std::map<BeaconAddress, Beacon> beacons_;
  TimeNs status_due_ns_ = 0;
  TimeNs status_last_ns_ = 0;
  std::uint64_t unwritten_ = 0;
  std::uint64_t unwritten_told_ = 0;
};

BridgeNode::Publisher::Publisher(const BridgeOptions& options, const StopSignal* stop)
    : lossless_(options.lossless),
      batch_(options.batch),
      stop_(stop),
      participant_(domain_options(options)),
      qos_(options.qos_file),
      others_(participant_, qos_),
      status_last_ns_(steady_now_ns()) {
  const auto delivery = lossless_ ? dds::Delivery::lossless : dds::Delivery::live;
  imu_writer_ = dds::make_writer(participant_, qos_, topics::imu, &imu_listener_, delivery);
  fix_writer_ = dds::make_writer(participant_, qos_, topics::fix, &fix_listener_, delivery);
  heading_writer_ = dds::make_writer(participant_, qos_, topics::heading, &heading_listener_, delivery);
  imu_deadline_ns_ = deadline_ns(imu_writer_);
  fix_deadline_ns_ = deadline_ns(fix_writer_);
  heading_deadline_ns_ = deadline_ns(heading_writer_);
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
  Beacon& beacon = beacons_[address];
  beacon.status.address = address;
  return beacon;
}

template <class T>
void BridgeNode::Publisher::write(dds::DataWriter<T>& writer, const T& sample) {
  dds::ReturnCode code = writer.try_write(sample);
  while (lossless_ && dds::is_timeout(code) && !stopped()) code = writer.try_write(sample);
  if (code < 0) ++unwritten_;
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

void BridgeNode::Publisher::note(Stream& stream, TimeNs deadline_ns) {
  ++stream.samples;
  stream.deadlines.on_sample(steady_now_ns(), deadline_ns);
}

void BridgeNode::Publisher::publish(ImuSample imu, Beacon& beacon) {
  note(beacon.imu, imu_deadline_ns_);
  imu.bridge_time_ns = now_ns();
  write(imu_writer_, dds::to_idl(imu));
}

void BridgeNode::Publisher::publish(const UltrasonicFix& fix, Beacon& beacon) {
  note(beacon.fix, fix_deadline_ns_);
  write(fix_writer_, dds::to_idl(fix));
}

void BridgeNode::Publisher::publish(const PairHeading& heading, Beacon& beacon) {
  note(beacon.heading, heading_deadline_ns_);
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

void BridgeNode::Publisher::tick() {
  flush();
  const TimeNs now = steady_now_ns();
  if (now >= status_due_ns_) publish_statuses(now);
}

void BridgeNode::Publisher::publish_statuses(TimeNs now) {
  constexpr TimeNs period_ns = 1'000'000'000;
  others_.look(status_writer_.instance_handle(),
               [this](BeaconAddress address) { return beacons_.contains(address); });
  for (auto& entry : beacons_) publish_status(entry.second, now);
  status_last_ns_ = now;
  status_due_ns_ = now + period_ns;
  tell_unwritten();
}

void BridgeNode::Publisher::tell_unwritten() {
  if (unwritten_ != unwritten_told_) {
    fmt::print(stderr, "sonopose-bridge: {} samples could not be written: a reader is too slow\n",
               unwritten_ - unwritten_told_);
    unwritten_told_ = unwritten_;
  }
}

void BridgeNode::Publisher::publish_status(Beacon& beacon, TimeNs now_steady_ns) {
  const double elapsed_s = seconds_between(status_last_ns_, now_steady_ns);
  const auto rate_hz = [elapsed_s](Stream& stream) {
    const auto samples = static_cast<double>(std::exchange(stream.samples, 0));
    return elapsed_s > 0.0 ? samples / elapsed_s : 0.0;
  };
  BeaconStatus& status = beacon.status;
  status.time_ns = now_ns();
  status.imu_rate_hz = rate_hz(beacon.imu);
  status.fix_rate_hz = rate_hz(beacon.fix);
  status.heading_rate_hz = rate_hz(beacon.heading);
  status.other_bridges = others_.count(status.address);
  status.imu_deadlines_missed = beacon.imu.deadlines.count(now_steady_ns, imu_deadline_ns_);
  status.fix_deadlines_missed = beacon.fix.deadlines.count(now_steady_ns, fix_deadline_ns_);
  status.heading_deadlines_missed = beacon.heading.deadlines.count(now_steady_ns, heading_deadline_ns_);
  status.liveliness_lost = ends_.liveliness_lost;
  status.readers_incompatible = ends_.incompatible_qos;
  status.samples_unwritten = unwritten_;
  write(status_writer_, dds::to_idl(beacon.status));
}

void BridgeNode::Publisher::wait_for_readers() {
  const auto all_matched = [this] {
    return imu_writer_.publication_matched_status().current_count > 0 &&
           fix_writer_.publication_matched_status().current_count > 0 &&
           heading_writer_.publication_matched_status().current_count > 0;
  };
  constexpr TimeNs look_period_ns = 20'000'000;
  constexpr TimeNs patience_ns = 3'000'000'000;
  const TimeNs began_ns = steady_now_ns();
  bool told = false;
  while (!all_matched()) {
    if (stop_->wait_until(steady_now_ns() + look_period_ns)) return;
    if (!told && steady_now_ns() - began_ns > patience_ns) {
      fmt::print(stderr, "sonopose-bridge: waiting for somebody to listen (is sonopose-fusion running?)\n");
      told = true;
    }
  }
}

void BridgeNode::Publisher::wait_until_read() {
  const auto wait = [this](auto& writer) {
    constexpr std::chrono::milliseconds step{200};
    constexpr int most_steps = 150;
    for (int i = 0; i < most_steps && !stopped(); ++i) {
      if (writer.wait_for_acknowledgments(step)) return;
    }
  };
  wait(imu_writer_);
  wait(fix_writer_);
  wait(heading_writer_);
  wait(truth_writer_);
}

BridgeNode::BridgeNode(const BridgeOptions& options) : publisher_(std::make_unique<Publisher>(options)) {}
BridgeNode::~BridgeNode() = default;

void BridgeNode::run(Source& source, const StopSignal& stop) {
  publisher_->obey(stop);
  if (source.is_recording()) publisher_->wait_for_readers();
  source.run(*publisher_, stop);
  publisher_->publish_statuses(steady_now_ns());
  publisher_->flush();
  if (source.is_recording()) publisher_->wait_until_read();
}

}  // namespace sonopose::nodes
