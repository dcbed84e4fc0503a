#include <sonopose/dds/conversions.hpp>
#include <sonopose/dds/participant.hpp>
#include <sonopose/dds/topics.hpp>
#include <sonopose/dds/waitset.hpp>
#include <sonopose/nodes/beacon_engines.hpp>
#include <sonopose/nodes/fusion_node.hpp>
#include <sonopose/nodes/gap_watch.hpp>
#include <sonopose/nodes/host_clock.hpp>

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace sonopose::nodes {
namespace {

namespace topics = dds::topics;

}  // namespace

class FusionNode::Impl {
public:
  explicit Impl(const FusionOptions& options);
  ~Impl();

  void publish_statuses();

private:
  template <class T>
  void take(dds::DataReader<T>& reader) noexcept {
    const TimeNs in_ns = now_ns();
    const TimeNs steady_ns = steady_now_ns();
    reader.try_take_each([&](const T& sample, const dds::SampleInfo&) {
      if (!stopping_) feed(dds::from_idl(sample), in_ns, steady_ns);  // a lossless reader may hold minutes
    });
  }
  void take(dds::DataReader<sonopose_ResetCommand>& reader) noexcept;
  void take(dds::DataReader<sonopose_SettingsRequest>& reader) noexcept;
  void feed(const Event& event, TimeNs in_ns, TimeNs steady_ns) noexcept;
  void write(FusedPose& pose) noexcept;
  void write(const SettingsInForce& change) noexcept;
  template <class T>
  void write_to(dds::DataWriter<T>& writer, const T& sample) noexcept;
  void tell_gaps();
  void serve_lossless(const std::stop_token& stop);

  /// Hands what one topic brings on, on the thread that received it.
  template <class T>
  class Listener final : public dds::DataReaderListener<T> {
  public:
    explicit Listener(Impl& node) : node_(node) {}
    void on_data_available(dds::DataReader<T>& reader) noexcept override { node_.take(reader); }

  private:
    Impl& node_;
  };

  bool lossless_;
  dds::DomainParticipant participant_;
  dds::QosProvider qos_;
  dds::Delivery delivery_;

  // Guards the engines, for computing alone: nothing is read or written under it.
  std::mutex engines_mutex_;
  BeaconEngines engines_;
  std::map<BeaconAddress, std::uint64_t> last_reset_ids_;  // of the receive thread
  // What one event brought about; of the feeding thread, kept for its capacity.
  std::vector<FusedPose> poses_;
  std::vector<FixReport> reports_;
  std::vector<SettingsInForce> changes_;
  std::atomic<std::uint64_t> unwritten_ = 0;
  std::uint64_t unwritten_told_ = 0;
  std::atomic<bool> stopping_ = false;
  std::atomic<bool> waited_for_consumer_ = false;  // since tell_gaps() last asked
  GapWatch gaps_;

  dds::DataWriter<sonopose_FusedPose> pose_writer_;
  dds::DataWriter<sonopose_FixReport> report_writer_;
  dds::DataWriter<sonopose_FusionStatus> status_writer_;
  dds::DataWriter<sonopose_SettingsReply> reply_writer_;
  dds::DataWriter<sonopose_EffectiveSettings> settings_writer_;

  Listener<sonopose_ImuSample> imu_listener_{*this};
  Listener<sonopose_UltrasonicFix> fix_listener_{*this};
  Listener<sonopose_PairHeading> heading_listener_{*this};
  Listener<sonopose_ResetCommand> reset_listener_{*this};
  Listener<sonopose_SettingsRequest> request_listener_{*this};
  // Readers last: their listeners may be called while the constructor still runs.
  dds::DataReader<sonopose_ImuSample> imu_reader_;
  dds::DataReader<sonopose_UltrasonicFix> fix_reader_;
  dds::DataReader<sonopose_PairHeading> heading_reader_;
  dds::DataReader<sonopose_ResetCommand> reset_reader_;
  dds::DataReader<sonopose_SettingsRequest> request_reader_;
  std::jthread lossless_thread_;
};

FusionNode::Impl::Impl(const FusionOptions& options)
    : lossless_(options.lossless),
      participant_(options.domain),
      qos_(options.qos_file),
      delivery_(options.lossless ? dds::Delivery::lossless : dds::Delivery::live),
      engines_(options.config, options.lossless),
      pose_writer_(dds::make_writer(participant_, qos_, topics::pose, nullptr, delivery_)),
      report_writer_(dds::make_writer(participant_, qos_, topics::report, nullptr, delivery_)),
      status_writer_(dds::make_writer(participant_, qos_, topics::fusion_status)),
      reply_writer_(dds::make_writer(participant_, qos_, topics::settings_reply)),
      settings_writer_(dds::make_writer(participant_, qos_, topics::settings)) {
  // Room for all that can come of one event: what waited for it.
  poses_.reserve(fusion::Sequencer::capacity + 1);
  reports_.reserve(fusion::Sequencer::capacity + 1);
  changes_.reserve(fusion::Sequencer::capacity + 1);
  write(engines_.settings_for_all());
  const auto live = [this](auto& listener) { return lossless_ ? nullptr : &listener; };
  fix_reader_ = dds::make_reader(participant_, qos_, topics::fix, live(fix_listener_), delivery_);
  heading_reader_ = dds::make_reader(participant_, qos_, topics::heading, live(heading_listener_), delivery_);
  imu_reader_ = dds::make_reader(participant_, qos_, topics::imu, live(imu_listener_), delivery_);
  reset_reader_ = dds::make_reader(participant_, qos_, topics::reset, &reset_listener_);
  request_reader_ = dds::make_reader(participant_, qos_, topics::settings_request, &request_listener_);
  if (lossless_) {
    lossless_thread_ = std::jthread([this](const std::stop_token& stop) { serve_lossless(stop); });
  }
}

FusionNode::Impl::~Impl() {
  stopping_ = true;
  lossless_thread_ = {};
  imu_reader_.close();
  fix_reader_.close();
  heading_reader_.close();
  reset_reader_.close();
  request_reader_.close();
  // Consumers hear at once that the poses end, and a standby takes over. (Lossless writers would wait for
  // room first: there the writers' own end must tell.)
  for (const BeaconAddress address : engines_.addresses()) {
    sonopose_FusedPose pose{};
    pose.address = address;
    if (!lossless_) pose_writer_.try_unregister_instance(pose);
    sonopose_FusionStatus status{};
    status.address = address;
    status_writer_.try_unregister_instance(status);
    sonopose_EffectiveSettings settings{};
    settings.address = address;
    settings_writer_.try_unregister_instance(settings);
  }
  sonopose_EffectiveSettings for_all{};
  for_all.address = all_beacons;
  settings_writer_.try_unregister_instance(for_all);
}

void FusionNode::Impl::feed(const Event& event, TimeNs in_ns, TimeNs steady_ns) noexcept {
  poses_.clear();
  reports_.clear();
  changes_.clear();
  {
    const std::lock_guard lock(engines_mutex_);
    engines_.push(
        event, steady_ns, [&](const FusedPose& pose) { poses_.push_back(pose); },
        [&](const FixReport& report) { reports_.push_back(report); },
        [&](const SettingsInForce& change) { changes_.push_back(change); });
  }
  for (FusedPose& pose : poses_) {
    pose.fusion_in_time_ns = in_ns;
    write(pose);
  }
  for (const FixReport& report : reports_) write_to(report_writer_, dds::to_idl(report));
  for (const SettingsInForce& change : changes_) write(change);
}

void FusionNode::Impl::write(FusedPose& pose) noexcept {
  pose.fusion_out_time_ns = now_ns();
  write_to(pose_writer_, dds::to_idl(pose));
}

void FusionNode::Impl::write(const SettingsInForce& change) noexcept {
  const EffectiveSettings settings{.address = change.address,
                                   .time_ns = now_ns(),
                                   .from_sequence = change.from_sequence,
                                   .values = config::texts_of(change.settings)};
  write_to(settings_writer_, dds::to_idl(settings).sample());
}

template <class T>
void FusionNode::Impl::write_to(dds::DataWriter<T>& writer, const T& sample) noexcept {
  if (lossless_ && stopping_) return;  // each try may wait for a consumer, and there may be many to write
  dds::ReturnCode code = writer.try_write(sample);
  while (lossless_ && dds::is_timeout(code) && !stopping_) {
    waited_for_consumer_ = true;
    code = writer.try_write(sample);
  }
  if (code < 0) unwritten_.fetch_add(1, std::memory_order_relaxed);
}

void FusionNode::Impl::take(dds::DataReader<sonopose_ResetCommand>& reader) noexcept {
  reader.try_take_each([this](const sonopose_ResetCommand& command, const dds::SampleInfo&) {
    std::uint64_t& last_id = last_reset_ids_[command.address];
    if (command.request_id != 0 && command.request_id == last_id) return;
    last_id = command.request_id;
    const std::lock_guard lock(engines_mutex_);
    engines_.reset(command.address);
  });
}

void FusionNode::Impl::take(dds::DataReader<sonopose_SettingsRequest>& reader) noexcept {
  reader.try_take_each([this](const sonopose_SettingsRequest& sample, const dds::SampleInfo&) {
    const SettingsRequest request = dds::from_idl(sample);
    SettingsReply reply;
    std::optional<SettingsInForce> for_all;
    {
      const std::lock_guard lock(engines_mutex_);
      reply = engines_.change_settings(request);
      if (reply.accepted && reply.address == all_beacons) for_all = engines_.settings_for_all();
    }
    if (for_all) write(*for_all);  // first: who has the answer can ask for what holds
    if (reply_writer_.try_write(dds::to_idl(reply).sample()) < 0) ++unwritten_;
  });
}

void FusionNode::Impl::serve_lossless(const std::stop_token& stop) {
  const dds::ReadCondition imu(imu_reader_);
  const dds::ReadCondition fix(fix_reader_);
  const dds::ReadCondition heading(heading_reader_);
  dds::WaitSet waitset;
  waitset += imu;
  waitset += fix;
  waitset += heading;
  while (!stop.stop_requested()) {
    waitset.wait(std::chrono::milliseconds(100));
    take(imu_reader_);
    take(fix_reader_);
    take(heading_reader_);
  }
}

void FusionNode::Impl::publish_statuses() {
  std::vector<FusionStatus> statuses;
  {
    const std::lock_guard lock(engines_mutex_);
    for (const BeaconAddress address : engines_.addresses()) statuses.push_back(*engines_.status(address));
  }
  for (FusionStatus& status : statuses) {
    status.time_ns = now_ns();
    if (status_writer_.try_write(dds::to_idl(status)) < 0) ++unwritten_;
  }
  if (lossless_) tell_gaps();
  const std::uint64_t unwritten = unwritten_;
  if (unwritten != unwritten_told_) {
    fmt::print(stderr, "sonopose-fusion: {} poses or reports could not be written: a consumer is too slow\n",
               unwritten - unwritten_told_);
    unwritten_told_ = unwritten;
  }
}

void FusionNode::Impl::tell_gaps() {
  if (waited_for_consumer_.exchange(false)) gaps_.start_over();
  std::vector<std::string> texts;
  {
    const std::lock_guard lock(engines_mutex_);
    for (const BeaconAddress address : engines_.addresses()) {
      if (auto text = gaps_.on(address, engines_.gap(address), steady_now_ns()))
        texts.push_back(*std::move(text));
    }
  }
  for (const std::string& text : texts) fmt::print(stderr, "sonopose-fusion: {}\n", text);
}

FusionNode::FusionNode(const FusionOptions& options) : impl_(std::make_unique<Impl>(options)) {}
FusionNode::~FusionNode() = default;

void FusionNode::run(const StopSignal& stop) {
  constexpr TimeNs period_ns = 1'000'000'000;
  TimeNs next_ns = steady_now_ns();
  do {
    impl_->publish_statuses();
    next_ns += period_ns;
  } while (!stop.wait_until(next_ns));
}

}  // namespace sonopose::nodes
