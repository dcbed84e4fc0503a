#include "publication/sensor_publisher.hpp"

#include "clocks/clocks.hpp"
#include "files/error.hpp"
#include "logging/increase_log.hpp"
#include "logging/later.hpp"
#include "logging/log.hpp"
#include "presence/silence.hpp"
#include "process/random_id.hpp"
#include "process/service.hpp"
#include "process_log/log_publisher.hpp"
#include "publication/background_recording.hpp"
#include "publication/deadline_count.hpp"
#include "publication/other_bridges.hpp"
#include "publication/recording_readers.hpp"
#include "publication/stationary_map.hpp"
#include "publication/topic_writers.hpp"
#include "transitions/transition_log.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/text/count_text.hpp>

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace sonopose::publication {
namespace {

/// True if a folder that cannot be made may be made later: a full disk has space, or another one is mounted.
bool waiting_may_help(const std::filesystem::path& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder, error)) return false;
  std::filesystem::path parent = folder.parent_path();
  while (!std::filesystem::exists(parent, error) && parent.has_relative_path()) parent = parent.parent_path();
  return std::filesystem::is_directory(parent, error);
}

/// Joins the domain. A live bridge does not wait for a stalled fusion.
dds::domain::DomainParticipant participant_in(dds::DomainOptions domain, const PublisherOptions& options) {
  domain.wait_for_readers = options.lossless;
  domain.batch_writes = options.batch;
  return dds::ext::participant(domain);
}

const PublisherOptions& without_domain(const PublisherOptions& options) {
  if (options.lossless || options.batch) {
    throw std::invalid_argument("a given participant has its own options of lossless and batched writes");
  }
  return options;
}

/// True for a sample that may belong to a beacon of another bridge.
bool is_aiding(const Event& event) {
  const auto* const heading = std::get_if<PairHeading>(&event);
  const auto* const fix = std::get_if<UltrasonicFix>(&event);
  return std::holds_alternative<TwistSample>(event) ||
         (heading != nullptr && (heading->flags & heading_flag_of_body) != 0) ||
         (fix != nullptr && (fix->flags & ultrasonic_flag_set_pose) != 0);
}

}  // namespace

class SensorPublisher::Publisher final : public SampleSink {
public:
  Publisher(const PublisherOptions& options, dds::domain::DomainParticipant participant);
  ~Publisher() override;
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  void on(const Event& event) override;
  void on(const TruthSample& truth) override;
  void on(const BeaconStatus& status) override;
  void on_stationary(const StationaryBeacon& beacon) override;
  void on_gone(BeaconAddress address) override;
  void on(const LineStatus& status) override;
  void flush() override { writers_.flush(); }
  void tick() override;

  /// Ends lossless writes and the waits below when `stop` is requested.
  void obey(const process::StopSignal& stop) {
    writers_.obey(stop);
    if (recording_) recording_->obey(stop);
  }
  void publish_statuses(SteadyTime now);
  void finish_log() {
    logging::later([log = transition_log_] { log->finish(); });
    log_unwritten(true);
  }
  [[nodiscard]] RecordingReaders& readers() { return readers_; }
  /// Throws files::IoError if samples were not recorded.
  void finish_recording() {
    if (recording_) recording_->finish();
  }

private:
  /// One stream of one beacon.
  struct Stream {
    explicit Stream(const dds::pub::AnyDataWriter& writer);
    void count_sample();

    std::uint64_t samples = 0;  ///< since the last status
    DeadlineCount deadlines;
    presence::Silence silence;
  };

  struct Beacon {
    explicit Beacon(const TopicWriters& writers)
        : imu(writers.imu()), fix(writers.fix()), heading(writers.heading()) {}

    std::uint64_t next_sequence = 1;
    bool is_own = false;  ///< numbered here, not by another bridge
    Stream imu;
    Stream fix;
    Stream heading;
    BeaconStatus status;
  };

  Beacon& beacon_of(BeaconAddress address);
  void own(Beacon& beacon);
  void publish(ImuSample imu, Beacon& beacon);
  void publish(const UltrasonicFix& fix, Beacon& beacon);
  void publish(const PairHeading& heading, Beacon& beacon);
  void publish(const TwistSample& twist, Beacon& /*beacon*/) { writers_.write(twist); }
  void publish_status(Beacon& beacon, SteadyTime now);
  void publish(LineStatus& line);
  void log(const transitions::Transition& transition, SteadyTime now);
  void log_unwritten(bool is_last = false);
  void log_silence(BeaconAddress address, transitions::Kind kind, Stream& stream, SteadyTime now);

  bool lossless_;
  bool reports_to_manager_;
  dds::domain::DomainParticipant participant_;
  dds::qos::Provider qos_;
  std::unique_ptr<process_log::LogPublisher> log_publisher_;
  TopicWriters writers_;
  OtherBridges others_;
  RecordingReaders readers_;
  std::optional<BackgroundRecording> recording_;
  std::map<BeaconAddress, Beacon> beacons_;
  std::map<BeaconAddress, std::uint64_t> next_sequences_;  ///< numbers for returning beacons
  std::uint64_t id_ = process::random_id();
  std::map<std::string, LineStatus> lines_;
  StationaryMap map_;
  SteadyTime status_due_;
  SteadyTime status_last_;
  logging::IncreaseLog unwritten_log_;
  /// Used in logging::later() only: the sample thread formats no lines.
  std::shared_ptr<transitions::TransitionLog> transition_log_ =
      std::make_shared<transitions::TransitionLog>();
};

SensorPublisher::Publisher::Publisher(const PublisherOptions& options,
                                      dds::domain::DomainParticipant participant)
    : lossless_(options.lossless),
      reports_to_manager_(options.publishes_log),
      participant_(std::move(participant)),
      qos_(options.qos_file),
      log_publisher_(options.publishes_log ? std::make_unique<process_log::LogPublisher>(participant_, qos_)
                                           : nullptr),
      writers_(participant_, qos_, lossless_ ? dds::topics::Delivery::lossless : dds::topics::Delivery::live,
               options.batch),
      others_(participant_, qos_),
      readers_(participant_, qos_, writers_, lossless_),
      status_last_(clocks::steady_now()) {
  if (!options.record_folder) return;
  try {
    recording_.emplace(*options.record_folder, options.source_settings,
                       lossless_ ? FullQueuePolicy::wait : FullQueuePolicy::lose);
  } catch (const files::IoError& error) {
    if (waiting_may_help(std::filesystem::absolute(*options.record_folder))) throw;
    throw std::invalid_argument(fmt::format("--record: {}", error.what()));
  }
}

SensorPublisher::Publisher::~Publisher() {
  for (const auto& entry : beacons_) writers_.unregister(entry.first);
  for (const auto& entry : lines_) writers_.unregister(entry.second);
  for (const auto& entry : map_.beacons()) writers_.unregister(entry.second);
}

// Samples

void SensorPublisher::Publisher::on(const Event& event) {
  Beacon& beacon = beacon_of(address_of(event));
  Event numbered = event;
  // A beacon that has only aiding here is numbered by another bridge.
  if (!is_aiding(event)) own(beacon);
  std::visit(
      [&beacon](auto& sample) {
        if (!beacon.is_own) return;
        if (sample.sequence == unnumbered) sample.sequence = beacon.next_sequence;
        beacon.next_sequence = sample.sequence + 1;
      },
      numbered);
  std::visit([&](const auto& sample) { publish(sample, beacon); }, numbered);
  if (recording_) recording_->push(numbered);
}

void SensorPublisher::Publisher::on(const TruthSample& truth) {
  own(beacon_of(truth.address));
  writers_.write(truth);
  if (recording_) recording_->push(truth);
}

void SensorPublisher::Publisher::on_stationary(const StationaryBeacon& beacon) {
  if (map_.update(beacon)) writers_.write(beacon);
}

SensorPublisher::Publisher::Beacon& SensorPublisher::Publisher::beacon_of(BeaconAddress address) {
  const auto [found, is_new] = beacons_.try_emplace(address, writers_);
  Beacon& beacon = found->second;
  if (!is_new) return beacon;
  beacon.status.address = address;
  if (const auto known = next_sequences_.find(address); known != next_sequences_.end()) {
    beacon.next_sequence = known->second;
  }
  log({.address = address, .kind = transitions::Kind::found}, clocks::steady_now());
  return beacon;
}

/// Begins to number a beacon and to publish its status.
void SensorPublisher::Publisher::own(Beacon& beacon) {
  if (std::exchange(beacon.is_own, true)) return;
  others_.watch(beacon.status.address);
}

/// Ends a beacon but keeps its numbering for its return: a fusion that still knows the beacon would take
/// lower numbers for late events.
void SensorPublisher::Publisher::on_gone(BeaconAddress address) {
  const auto found = beacons_.find(address);
  if (found == beacons_.end()) return;
  next_sequences_[address] = found->second.next_sequence;
  writers_.unregister(address);
  others_.forget(address);
  beacons_.erase(found);
  logging::later([address, log = transition_log_] {
    log->forget(address);
    logging::info(fmt::format("beacon {}: gone; its streams end until it returns", address));
  });
}

void SensorPublisher::Publisher::publish(ImuSample imu, Beacon& beacon) {
  beacon.imu.count_sample();
  imu.bridge_time_ns = clocks::host_now();
  writers_.write(imu);
}

void SensorPublisher::Publisher::publish(const UltrasonicFix& fix, Beacon& beacon) {
  beacon.fix.count_sample();
  writers_.write(fix);
}

void SensorPublisher::Publisher::publish(const PairHeading& heading, Beacon& beacon) {
  beacon.heading.count_sample();
  writers_.write(heading);
}

SensorPublisher::Publisher::Stream::Stream(const dds::pub::AnyDataWriter& writer)
    : deadlines(dds::ext::to_chrono(writer.qos().policy<dds::policy::Deadline>().period()).count()) {}

void SensorPublisher::Publisher::Stream::count_sample() {
  const SteadyTime now = clocks::steady_now();
  ++samples;
  deadlines.on_sample(now);
  silence.on_sample(now);
}

// Statuses

void SensorPublisher::Publisher::on(const BeaconStatus& status) {
  Beacon& beacon = beacon_of(status.address);
  own(beacon);
  beacon.status = status;
}

void SensorPublisher::Publisher::on(const LineStatus& status) {
  LineStatus& line = lines_[status.name];
  const bool has_changed = line.state != status.state;
  line = status;
  line.bridge_id = id_;
  if (has_changed) publish(line);
}

void SensorPublisher::Publisher::publish(LineStatus& line) {
  line.time_ns = clocks::host_now();
  writers_.write(line);
}

void SensorPublisher::Publisher::tick() {
  flush();
  const SteadyTime now = clocks::steady_now();
  if (reports_to_manager_) {
    process::report_ready();
    process::report_progress(now);
  }
  if (now >= status_due_) publish_statuses(now);
}

void SensorPublisher::Publisher::publish_statuses(SteadyTime now) {
  constexpr TimeNs period_ns = 1'000'000'000;
  others_.update(writers_.status().instance_handle());
  for (auto& [address, beacon] : beacons_) {
    if (!beacon.is_own) continue;
    publish_status(beacon, now);
    log_silence(address, transitions::Kind::imu_silent, beacon.imu, now);
    log_silence(address, transitions::Kind::fixes_silent, beacon.fix, now);
  }
  logging::later([now, log = transition_log_] {
    log->update(now);
    logging::report_left_out();
  });
  for (auto& entry : lines_) publish(entry.second);
  status_last_ = now;
  status_due_ = now + period_ns;
  log_unwritten();
  readers_.check();
}

void SensorPublisher::Publisher::publish_status(Beacon& beacon, SteadyTime now) {
  const double elapsed_s = seconds_between(status_last_, now);
  const auto rate_hz = [elapsed_s](Stream& stream) {
    const auto samples = static_cast<double>(std::exchange(stream.samples, 0));
    return elapsed_s > 0.0 ? samples / elapsed_s : 0.0;
  };
  BeaconStatus& status = beacon.status;
  status.time_ns = clocks::host_now();
  status.imu_rate_hz = rate_hz(beacon.imu);
  status.fix_rate_hz = rate_hz(beacon.fix);
  status.heading_rate_hz = rate_hz(beacon.heading);
  status.other_bridges = others_.count(status.address);
  status.imu_deadlines_missed = beacon.imu.deadlines.count(now);
  status.fix_deadlines_missed = beacon.fix.deadlines.count(now);
  status.heading_deadlines_missed = beacon.heading.deadlines.count(now);
  status.liveliness_lost = writers_.endpoints().liveliness_lost;
  status.readers_incompatible = writers_.endpoints().incompatible_qos;
  status.samples_unwritten = writers_.unwritten();
  status.samples_unrecorded = recording_ ? recording_->lost() : 0;
  writers_.write(status);
}

void SensorPublisher::Publisher::log(const transitions::Transition& transition, SteadyTime now) {
  logging::later([transition, now, log = transition_log_] { log->on(transition, now); });
}

void SensorPublisher::Publisher::log_unwritten(bool is_last) {
  const std::uint64_t unwritten = writers_.unwritten();
  const auto more =
      is_last ? unwritten_log_.finish(unwritten) : unwritten_log_.update(unwritten, clocks::steady_now());
  if (!more) return;
  logging::later([count = *more] {
    logging::warning(
        fmt::format("{} could not be written: a reader is too slow", text::count_text(count, "sample")));
  });
}

/// Logs a silence, unless lossless: such streams wait for their readers.
void SensorPublisher::Publisher::log_silence(BeaconAddress address, transitions::Kind kind, Stream& stream,
                                             SteadyTime now) {
  constexpr TimeNs silence_limit_ns = 3'000'000'000;  // as for a line without bytes
  if (lossless_) return;
  const auto change = stream.silence.find_change(now, silence_limit_ns);
  if (!change) return;
  log({.address = address, .kind = kind, .begins = change->silent, .lasted_s = change->lasted_s}, now);
}

SensorPublisher::SensorPublisher(const dds::DomainOptions& domain, const PublisherOptions& options)
    : publisher_(std::make_unique<Publisher>(options, participant_in(domain, options))) {}
SensorPublisher::SensorPublisher(const dds::domain::DomainParticipant& participant,
                                 const PublisherOptions& options)
    : publisher_(std::make_unique<Publisher>(without_domain(options), participant)) {}
SensorPublisher::~SensorPublisher() = default;

void SensorPublisher::run(Source& source, const process::StopSignal& stop) {
  publisher_->obey(stop);
  if (source.is_recording()) publisher_->readers().wait(stop);
  source.run(*publisher_, stop);
  publisher_->publish_statuses(clocks::steady_now());
  publisher_->finish_log();
  publisher_->flush();
  if (source.is_recording()) publisher_->readers().finish(stop);
}

std::uint64_t SensorPublisher::lost_by_fusions() const {
  return publisher_->readers().lost();
}

void SensorPublisher::finish() {
  publisher_->finish_recording();
}

}  // namespace sonopose::publication
