#pragma once
// The relay: what it reads on the native side, and the topics of the beacons that it has heard of.

#include "ros2_beacon.hpp"
#include <sonopose/dds/conversions.hpp>
#include <sonopose/dds/participant.hpp>
#include <sonopose/dds/topics.hpp>
#include <sonopose/nodes/beacon_view.hpp>
#include <sonopose/nodes/host_clock.hpp>
#include <sonopose/nodes/ros2_diagnostics.hpp>
#include <sonopose/nodes/ros2_parameter_server.hpp>
#include <sonopose/nodes/ros2_relay.hpp>

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <type_traits>
#include <utility>
#include <vector>

namespace sonopose::nodes {

class Ros2Relay::Impl {
public:
  explicit Impl(const Ros2RelayOptions& options);

  void run(const StopSignal& stop);

private:
  /// Hands the samples of one native topic to the beacon's outputs and to its watch.
  template <class T>
  class Listener final : public dds::DataReaderListener<T> {
  public:
    explicit Listener(Impl& relay) : relay_(relay) {}

    void on_data_available(dds::DataReader<T>& reader) noexcept override {
      reader.try_take_each(
          [this](const T& sample, const dds::SampleInfo&) { relay_.on(dds::from_idl(sample)); },
          [this](const T& key, const dds::SampleInfo& info) {
            if (!info.alive()) relay_.on_gone(key);
          });
    }
    void on_liveliness_changed(dds::DataReader<T>& /*reader*/,
                               const dds::LivelinessChangedStatus& status) noexcept override {
      if (std::is_same_v<T, sonopose_FusedPose> && status.alive_count == 0) relay_.on_poses_lost();
    }
    void on_requested_deadline_missed(dds::DataReader<T>& reader,
                                      const dds::RequestedDeadlineMissedStatus& status) noexcept override {
      T key{};
      if (!std::is_same_v<T, sonopose_FusedPose> ||
          reader.try_key_value(key, {status.last_instance_handle}) < 0) {
        return;
      }
      relay_.on_deadline_missed(key.address, static_cast<std::uint64_t>(status.total_count_change));
    }

  private:
    Impl& relay_;
  };

  /// One native topic.
  template <class T>
  struct Input {
    explicit Input(Impl& relay) : listener(relay) {}
    Listener<T> listener;
    dds::DataReader<T> reader;
  };

  class TfListener final : public dds::DataReaderListener<ros2::TFMessage> {
  public:
    explicit TfListener(Impl& relay) : relay_(relay) {}
    void on_data_available(dds::DataReader<ros2::TFMessage>& reader) noexcept override {
      reader.try_take_each([this](const ros2::TFMessage& message, const dds::SampleInfo&) {
        for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
          relay_.on_transform(message.transforms._buffer[i]);
        }
      });
    }

  private:
    Impl& relay_;
  };

  /// What is told of a beacon in diagnostics.
  struct Watched {
    BeaconWatch watch;
    BeaconView before;
  };

  /// Samples, fixes and reports.
  template <class Sample>
  void on(const Sample& sample) {
    if (Ros2Beacon* const outputs = outputs_of(sample.address)) outputs->on(sample);
  }
  void on(const FusedPose& pose) {
    const TimeNs received_ns = now_ns();
    if (Ros2Beacon* const outputs = outputs_of(pose.address)) outputs->on(pose);
    watch(pose.address, [&](BeaconWatch& watch) { watch.on(pose, received_ns); });
  }
  void on(const BeaconStatus& status) {
    watch(status.address, [&](BeaconWatch& watch) { watch.on(status); });
  }
  void on(const FusionStatus& status) {
    watch(status.address, [&](BeaconWatch& watch) { watch.on(status); });
  }
  void on(const EffectiveSettings& settings);
  template <class Action>
  void watch(BeaconAddress address, const Action& action) {
    if (!options_.addresses.contains(address)) return;
    const std::lock_guard lock(mutex_);
    action(watched_[address].watch);
  }

  /// An instance lost its last writer.
  void on_gone(const sonopose_FusedPose& key) {
    watch(key.address, [](BeaconWatch& watch) { watch.on_pose_lost(); });
  }
  void on_gone(const sonopose_FusionStatus& key) {
    watch(key.address, [&key](BeaconWatch& watch) { watch.on_fusion_gone(key.fusion_id); });
  }
  template <class Other>
  void on_gone(const Other& /*key*/) {}
  void on_poses_lost() {
    const std::lock_guard lock(mutex_);
    for (auto& [address, watched] : watched_) watched.watch.on_pose_lost();
  }
  void on_deadline_missed(BeaconAddress address, std::uint64_t more) {
    watch(address, [more](BeaconWatch& watch) { watch.on_deadline_missed(more); });
  }
  void on_transform(const ros2::TransformStamped& transform);

  /// The beacon's topics; null where they are not there (yet).
  Ros2Beacon* outputs_of(BeaconAddress address);
  template <class Action>
  void for_each_output(const Action& action);
  void make_new_outputs();
  dds::DataWriter<ros2::TFMessage>* transforms_for(BeaconAddress address);
  void publish_static_transforms();
  void publish_diagnostics();
  void judge_transforms(const Ros2Beacon& outputs, ros2::Diagnostic& diagnostic) const;
  void serve(const StopSignal& stop);
  void serve_parameters(const std::stop_token& end, const StopSignal& stop);

  [[nodiscard]] const std::string& node_name() const { return options_.names.node().name; }

  Ros2RelayOptions options_;
  dds::DomainParticipant participant_;
  dds::QosProvider qos_;
  ros2::Node node_;
  Ros2ParameterServer parameters_;
  dds::DataWriter<ros2::DiagnosticArray> diagnostics_writer_;
  dds::DataWriter<ros2::TFMessage> tf_writer_;
  dds::DataWriter<ros2::TFMessage> static_tf_writer_;
  std::optional<BeaconAddress> tf_owner_;

  std::mutex mutex_;                                              ///< of what follows
  std::map<BeaconAddress, std::unique_ptr<Ros2Beacon>> outputs_;  ///< null: to be made; never taken away
  std::map<BeaconAddress, Watched> watched_;
  std::map<BeaconAddress, EffectiveSettings> settings_in_force_;  ///< may come before anything else
  bool has_new_ = false;

  // Readers last: they go first, and no callback finds what is gone already.
  TfListener tf_listener_{*this};
  dds::DataReader<ros2::TFMessage> tf_reader_;
  Input<sonopose_ImuSample> imu_{*this};
  Input<sonopose_UltrasonicFix> fix_{*this};
  Input<sonopose_FusedPose> pose_{*this};
  Input<sonopose_FixReport> report_{*this};
  Input<sonopose_EffectiveSettings> settings_{*this};
  Input<sonopose_BeaconStatus> beacon_status_{*this};
  Input<sonopose_FusionStatus> fusion_status_{*this};
};

template <class Action>
void Ros2Relay::Impl::for_each_output(const Action& action) {
  std::vector<Ros2Beacon*> all;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [address, outputs] : outputs_) {
      if (outputs) all.push_back(outputs.get());
    }
  }
  for (Ros2Beacon* const outputs : all) action(*outputs);
}

}  // namespace sonopose::nodes
