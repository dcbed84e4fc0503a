#include "bare_chain.hpp"

#include <sonopose/dds/domain.hpp>
#include <sonopose/idl/sonopose.h>
#include <sonopose/nodes/host_clock.hpp>

#include <dds/dds.h>

#include <array>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <time.h>

namespace sonopose::benchmarks {
namespace {

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(std::string("bare chain: ") + dds_strretcode(entity));
  return entity;
}

/// What the Imu and Pose profiles say, said in C.
dds_qos_t* stream_qos(bool exclusive) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(2));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 64);
  dds_qset_deadline(qos, DDS_MSECS(100));
  dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_SECS(1));
  if (exclusive) dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
  return qos;
}

dds_entity_t join(std::uint32_t domain) {
  const std::string config = dds::domain_configuration(domain, dds::Network::loopback, "");
  checked(dds_create_domain(domain, config.c_str()));
  return checked(dds_create_participant(domain, nullptr, nullptr));
}

dds_entity_t imu_topic(dds_entity_t participant) {
  return checked(dds_create_topic(participant, &sonopose_ImuSample_desc, "sonopose/imu", nullptr, nullptr));
}

void on_imu(dds_entity_t reader, void* writer) {
  std::array<void*, 16> samples{};
  std::array<dds_sample_info_t, 16> infos{};
  const std::int64_t in_ns = nodes::now_ns();
  const dds_return_t count = dds_take(reader, samples.data(), infos.data(), samples.size(), samples.size());
  for (dds_return_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!infos[at].valid_data) continue;
    const auto& imu = *static_cast<const sonopose_ImuSample*>(samples[at]);
    sonopose_FusedPose pose{};
    pose.address = imu.address;
    pose.event_sequence = imu.event_sequence;
    pose.time = imu.sensor_time;
    pose.imu_bridge_time = imu.bridge_time;
    pose.fusion_in_time = in_ns;
    pose.fusion_out_time = nodes::now_ns();
    dds_write(*static_cast<dds_entity_t*>(writer), &pose);
  }
  if (count > 0) dds_return_loan(reader, samples.data(), count);
}

void sleep_until(std::int64_t steady_ns) {
  const timespec until{static_cast<time_t>(steady_ns / 1'000'000'000),
                       static_cast<long>(steady_ns % 1'000'000'000)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

}  // namespace

void run_bare_source(std::uint32_t domain, double rate_hz) {
  const dds_entity_t participant = join(domain);
  const dds_entity_t writer =
      checked(dds_create_writer(participant, imu_topic(participant), stream_qos(false), nullptr));
  const auto period_ns = static_cast<std::int64_t>(1e9 / rate_hz);
  std::int64_t next_ns = nodes::steady_now_ns();
  sonopose_ImuSample imu{};
  imu.address = 7;
  while (true) {
    sleep_until(next_ns);
    next_ns += period_ns;
    ++imu.event_sequence;
    imu.sensor_time = imu.bridge_time = nodes::now_ns();
    dds_write(writer, &imu);
  }
}

void run_bare_relay(std::uint32_t domain) {
  const dds_entity_t participant = join(domain);
  const dds_entity_t pose_topic =
      checked(dds_create_topic(participant, &sonopose_FusedPose_desc, "sonopose/pose", nullptr, nullptr));
  dds_entity_t writer = checked(dds_create_writer(participant, pose_topic, stream_qos(true), nullptr));
  dds_listener_t* listener = dds_create_listener(&writer);
  dds_lset_data_available(listener, on_imu);
  checked(dds_create_reader(participant, imu_topic(participant), stream_qos(false), listener));
  while (true) ::poll(nullptr, 0, -1);
}

}  // namespace sonopose::benchmarks
