#include "faults/observer.hpp"

#include "clocks/clocks.hpp"

#include <algorithm>

namespace sonopose::faults {

template <class T>
class Observer::Listener final : public dds::sub::NoOpDataReaderListener<T> {
public:
  explicit Listener(Observer& observer) : observer_(observer) {}

  void on_data_available(dds::sub::DataReader<T>& reader) noexcept override {
    const SteadyTime received = clocks::steady_now();
    {
      const std::lock_guard lock(observer_.mutex_);
      dds::ext::try_take_each(reader, [&](const T& sample, const dds::sub::SampleInfo& info) {
        observer_.on(reader, sample, info.publication_handle().c_value(), received);
      });
    }
    observer_.came_.notify_all();
  }

  void on_subscription_matched(dds::sub::DataReader<T>& reader,
                               const dds::core::status::SubscriptionMatchedStatus& status) noexcept override {
    if (status.current_count_change() <= 0) return;
    const std::lock_guard lock(observer_.mutex_);
    observer_.writer_of(reader, status.last_publication_handle().c_value());
  }

  void on_liveliness_changed(dds::sub::DataReader<T>& /*reader*/,
                             const dds::core::status::LivelinessChangedStatus& status) noexcept override {
    if (!std::is_same_v<T, sonopose_FusedPose> || status.not_alive_count_change() <= 0) return;
    const std::lock_guard lock(observer_.mutex_);
    observer_.losses_.push_back({clocks::steady_now(), status.last_publication_handle().c_value()});
  }

  void on_sample_lost(dds::sub::DataReader<T>& /*reader*/,
                      const dds::core::status::SampleLostStatus& status) noexcept override {
    if (!std::is_same_v<T, sonopose_FusedPose>) return;
    const std::lock_guard lock(observer_.mutex_);
    observer_.lost_ += static_cast<std::uint64_t>(std::max(0, status.total_count_change()));
  }

  void on_sample_rejected(dds::sub::DataReader<T>& /*reader*/,
                          const dds::core::status::SampleRejectedStatus& status) noexcept override {
    if (!std::is_same_v<T, sonopose_FusedPose>) return;
    const std::lock_guard lock(observer_.mutex_);
    observer_.rejected_ += static_cast<std::uint64_t>(std::max(0, status.total_count_change()));
  }

private:
  Observer& observer_;
};

Observer::Observer(const test::Bus& bus)
    : pose_listener_(std::make_unique<Listener<sonopose_FusedPose>>(*this)),
      imu_listener_(std::make_unique<Listener<sonopose_ImuSample>>(*this)),
      status_listener_(std::make_unique<Listener<sonopose_FusionStatus>>(*this)),
      participant_(dds::ext::participant({.domain_id = bus.domain_id()})) {
  const dds::qos::Provider qos;
  namespace topics = dds::topics;
  status_reader_ = topics::make_reader(participant_, qos, topics::fusion_status, status_listener_.get());
  imu_reader_ = topics::make_reader(participant_, qos, topics::imu, imu_listener_.get());
  pose_reader_ = topics::make_reader(participant_, qos, topics::pose, pose_listener_.get());
}

Observer::~Observer() = default;

Observer::Writer Observer::writer_of(const dds::core::Entity& reader, std::uint64_t writer) {
  const auto found = writers_.find(writer);
  if (found != writers_.end()) return found->second;
  dds_builtintopic_endpoint_t* data = dds_get_matched_publication_data(dds::ext::try_handle(reader), writer);
  if (data == nullptr) return {};
  Writer known{data->participant_instance_handle, 0};
  dds_qget_ownership_strength(data->qos, &known.strength);
  dds_builtintopic_free_endpoint(data);
  writers_.emplace(writer, known);
  return known;
}

void Observer::on(const dds::sub::DataReader<sonopose_FusedPose>& reader, const sonopose_FusedPose& pose,
                  std::uint64_t writer, SteadyTime received) {
  const Writer known = writer_of(reader, writer);
  poses_.push_back({.received = received,
                    .received_host_ns = clocks::host_now(),
                    .process = known.process,
                    .writer = writer,
                    .strength = known.strength,
                    .address = pose.address,
                    .sequence = pose.event_sequence,
                    .time_ns = pose.time,
                    .bridge_time_ns = pose.imu_bridge_time,
                    .status = pose.status,
                    .reset_counter = pose.reset_counter});
}

void Observer::on(const dds::sub::DataReader<sonopose_ImuSample>& /*reader*/, const sonopose_ImuSample& imu,
                  std::uint64_t /*writer*/, SteadyTime received) {
  imu_.push_back({received, imu.address, imu.event_sequence, imu.bridge_time});
}

void Observer::on(const dds::sub::DataReader<sonopose_FusionStatus>& reader,
                  const sonopose_FusionStatus& status, std::uint64_t writer, SteadyTime received) {
  reports_.push_back({received, writer_of(reader, writer).process, dds::topics::from_idl(status)});
}

void Observer::start() {
  const std::lock_guard lock(mutex_);
  constexpr TimeNs on_the_way_ns = 1'000'000'000;  // the poses of these samples are still to come
  const SteadyTime begin = clocks::steady_now();
  poses_.clear();
  std::erase_if(imu_, [&](const Published& imu) { return imu.received < begin - on_the_way_ns; });
  lost_ = 0;
  rejected_ = 0;
}

void Observer::add_to(History& history) const {
  const std::lock_guard lock(mutex_);
  history.poses = poses_;
  history.imu = imu_;
  history.statuses = reports_;
  history.losses = losses_;
  history.consumer_lost = lost_;
  history.consumer_rejected = rejected_;
}

}  // namespace sonopose::faults
