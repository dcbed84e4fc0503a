#include "bare_chain.hpp"

#include "clocks/clocks.hpp"
#include "pulse.hpp"
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/idl/sonopose.h>

#include <dds/dds.h>

#include <array>
#include <cstdlib>
#include <poll.h>
#include <stdexcept>
#include <string>

namespace sonopose::benchmarks {
namespace {

namespace topics = dds::topics;

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(std::string("bare chain: ") + dds_strretcode(entity));
  return entity;
}

/// Loads the same profiles as the real chain.
const dds::qos::Provider& profiles() {
  static const dds::qos::Provider provider;
  return provider;
}

const dds_qos_t* writer_qos(const char* profile) {
  return profiles().datawriter_qos(profile).get();
}

/// Joins with the configuration of the real chain; secured as that one if the environment says so.
dds_entity_t join(std::uint32_t domain, const char* role) {
  ::setenv("ROS_SECURITY_ENCLAVE_OVERRIDE", role, 1);
  static const auto participant = dds::ext::participant({.domain_id = domain});
  return dds::ext::handle(participant);
}

dds_entity_t imu_topic(dds_entity_t participant) {
  return checked(dds_create_topic(participant, &sonopose_ImuSample_desc, topics::imu.name, nullptr, nullptr));
}

void on_imu(dds_entity_t reader, void* writer) {
  std::array<void*, 16> samples{};
  std::array<dds_sample_info_t, 16> infos{};
  const std::int64_t in_ns = clocks::host_now();
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
    pose.fusion_out_time = clocks::host_now();
    dds_write(*static_cast<dds_entity_t*>(writer), &pose);
  }
  if (count > 0) dds_return_loan(reader, samples.data(), count);
}

}  // namespace

void run_bare_source(std::uint32_t domain, double rate_hz) {
  const dds_entity_t participant = join(domain, "bridge");
  const dds_entity_t writer = checked(
      dds_create_writer(participant, imu_topic(participant), writer_qos(topics::imu.profile), nullptr));
  run_source(rate_hz, [writer](const sonopose_ImuSample& imu) { dds_write(writer, &imu); });
}

void run_bare_relay(std::uint32_t domain) {
  const dds_entity_t participant = join(domain, "fusion");
  const dds_entity_t pose_topic =
      checked(dds_create_topic(participant, &sonopose_FusedPose_desc, topics::pose.name, nullptr, nullptr));
  dds_entity_t writer =
      checked(dds_create_writer(participant, pose_topic, writer_qos(topics::pose.profile), nullptr));
  dds_listener_t* listener = dds_create_listener(&writer);
  dds_lset_data_available(listener, on_imu);
  checked(dds_create_reader(participant, imu_topic(participant),
                            profiles().datareader_qos(topics::imu.profile).get(), listener));
  while (true) ::poll(nullptr, 0, -1);
}

}  // namespace sonopose::benchmarks
