#include "bare_relay.hpp"

#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/ros2/messages/idl_types.hpp>

#include <dds/dds.h>
#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace sonopose::benchmarks {
namespace {

namespace topics = dds::topics;

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) throw std::runtime_error(std::string("bare relay: ") + dds_strretcode(-entity));
  return entity;
}

const dds::qos::Provider& profiles() {
  static const dds::qos::Provider provider;
  return provider;
}

dds_entity_t join(std::uint32_t domain) {
  checked(dds_create_domain(domain, dds::domain_configuration(domain, {}, "").c_str()));
  return checked(dds_create_participant(domain, nullptr, nullptr));
}

template <class T>
dds_entity_t ros_topic(dds_entity_t participant, const std::string& name) {
  return checked(dds_create_topic(participant, &dds::TopicTraits<T>::descriptor(), ("rt/" + name).c_str(),
                                  nullptr, nullptr));
}

template <class T>
dds_entity_t ros_writer(dds_entity_t participant, const std::string& name,
                        const char* profile = "ros2::Default") {
  return checked(dds_create_writer(participant, ros_topic<T>(participant, name),
                                   profiles().datawriter_qos(profile).get(), nullptr));
}

/// Strings of the messages, as long as those of the relay.
std::string map_frame = "map";
std::string base_frame = "base_link";
std::string imu_frame = "imu_link";

/// The writers and messages of one beacon.
struct Beacon {
  Beacon(dds_entity_t participant, std::uint32_t address) {
    const std::string prefix = fmt::format("hedge_{}/", address);
    raw_imu = ros_writer<ros2::Imu>(participant, prefix + "imu/data_raw");
    imu = ros_writer<ros2::Imu>(participant, prefix + "imu/data");
    odometry = ros_writer<ros2::Odometry>(participant, prefix + "odom");
    pose = ros_writer<ros2::PoseWithCovarianceStamped>(participant, prefix + "pose");
    fix = ros_writer<ros2::PoseWithCovarianceStamped>(participant, prefix + "fix");
  }
  dds_entity_t raw_imu;
  dds_entity_t imu;
  dds_entity_t odometry;
  dds_entity_t pose;
  dds_entity_t fix;
};

struct State {
  std::vector<Beacon> beacons;
  dds_entity_t tf = 0;
  ros2::Imu imu{};
  ros2::Odometry odometry{};
  ros2::PoseWithCovarianceStamped pose{};
  ros2::TransformStamped transform{};

  State() {
    imu.header.frame_id = imu_frame.data();
    odometry.header.frame_id = map_frame.data();
    odometry.child_frame_id = base_frame.data();
    pose.header.frame_id = map_frame.data();
    transform.header.frame_id = map_frame.data();
    transform.child_frame_id = base_frame.data();
  }
  void on(const sonopose_ImuSample& /*sample*/, const Beacon& beacon) const {
    dds_write(beacon.raw_imu, &imu);
  }
  void on(const sonopose_FixReport& /*report*/, const Beacon& beacon) const { dds_write(beacon.fix, &pose); }
  void on(const sonopose_FusedPose& /*pose*/, const Beacon& beacon) {
    ros2::TFMessage message{{1, 1, &transform, false}};
    dds_write(tf, &message);
    dds_write(beacon.odometry, &odometry);
    dds_write(beacon.pose, &pose);
    dds_write(beacon.imu, &imu);
  }
};

template <class T>
void on_data(dds_entity_t reader, void* state_of_process) {
  State& state = *static_cast<State*>(state_of_process);
  std::array<void*, 16> samples{};
  std::array<dds_sample_info_t, 16> infos{};
  const dds_return_t count = dds_take(reader, samples.data(), infos.data(), samples.size(), samples.size());
  for (dds_return_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!infos[at].valid_data) continue;
    const T& sample = *static_cast<const T*>(samples[at]);
    const std::size_t beacon = sample.address - first_relayed_address;
    if (beacon < state.beacons.size()) state.on(sample, state.beacons[beacon]);
  }
  if (count > 0) dds_return_loan(reader, samples.data(), count);
}

template <class T>
void subscribe(dds_entity_t participant, const topics::Entry<T>& entry, State& state) {
  dds_listener_t* const listener = dds_create_listener(&state);
  dds_lset_data_available(listener, on_data<T>);
  const dds_entity_t topic = checked(
      dds_create_topic(participant, &dds::TopicTraits<T>::descriptor(), entry.name, nullptr, nullptr));
  checked(dds_create_reader(participant, topic, profiles().datareader_qos(entry.profile).get(), listener));
  dds_delete_listener(listener);
}

[[noreturn]] void sleep_until_killed() {
  while (true) ::pause();
}

}  // namespace

void relay_bare(std::uint32_t domain, std::uint32_t beacons) {
  const dds_entity_t participant = join(domain);
  State state;
  for (std::uint32_t i = 0; i < beacons; ++i) {
    state.beacons.emplace_back(participant, first_relayed_address + i);
  }
  state.tf = ros_writer<ros2::TFMessage>(participant, "tf", "ros2::Tf");
  subscribe(participant, topics::imu, state);
  subscribe(participant, topics::pose, state);
  subscribe(participant, topics::report, state);
  sleep_until_killed();
}

void consume_relayed(std::uint32_t domain, std::uint32_t beacons) {
  const dds_entity_t participant = join(domain);
  dds_listener_t* const listener = dds_create_listener(nullptr);
  dds_lset_data_available(listener, [](dds_entity_t reader, void* /*arg*/) {
    std::array<void*, 16> samples{};
    std::array<dds_sample_info_t, 16> infos{};
    const dds_return_t count = dds_take(reader, samples.data(), infos.data(), samples.size(), samples.size());
    if (count > 0) dds_return_loan(reader, samples.data(), count);
  });
  const auto read = [&](dds_entity_t topic) {
    checked(
        dds_create_reader(participant, topic, profiles().datareader_qos("ros2::Default").get(), listener));
  };
  for (std::uint32_t i = 0; i < beacons; ++i) {
    const std::string prefix = fmt::format("hedge_{}/", first_relayed_address + i);
    for (const char* const name : {"imu/data_raw", "imu/data"}) {
      read(ros_topic<ros2::Imu>(participant, prefix + name));
    }
    read(ros_topic<ros2::Odometry>(participant, prefix + "odom"));
    for (const char* const name : {"pose", "fix"}) {
      read(ros_topic<ros2::PoseWithCovarianceStamped>(participant, prefix + name));
    }
  }
  read(ros_topic<ros2::TFMessage>(participant, "tf"));
  sleep_until_killed();
}

}  // namespace sonopose::benchmarks
