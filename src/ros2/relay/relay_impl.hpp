#pragma once
// The relay: what it reads on the native side, and the topics of the beacons that it has heard of.

#include "ros2/relay/beacon.hpp"
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include "observation/beacon_observers.hpp"
#include "ros2/relay/diagnostics.hpp"
#include "ros2/relay/parameter_server.hpp"
#include "ros2/relay/relay.hpp"

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

namespace sonopose::ros2 {

class Ros2Relay::Impl {
public:
  explicit Impl(const Ros2RelayOptions& options);

  void run(const process::StopSignal& stop);

private:
  /// Hands the samples of one native topic to the beacon's topics.
  template <class T>
  class OutputListener final : public process::CountingReaderListener<T> {
  public:
    explicit OutputListener(Impl& relay) : process::CountingReaderListener<T>(relay.ends_), relay_(relay) {}
    void on_data_available(dds::DataReader<T>& reader) noexcept override {
      reader.try_take_each(
          [this](const T& sample, const dds::SampleInfo&) { relay_.on(dds::from_idl(sample)); });
    }

  private:
    Impl& relay_;
  };

  /// Poses are watched besides, for diagnostics.
  class PoseListener final : public observation::ObservingListener<sonopose_FusedPose> {
  public:
    explicit PoseListener(Impl& relay) : ObservingListener(relay.watches_, relay.ends_), relay_(relay) {}

  private:
    void on_sample(const FusedPose& pose) noexcept override { relay_.on(pose); }

    Impl& relay_;
  };

  /// One native topic.
  template <class T, class Listener = OutputListener<T>>
  struct Input {
    template <class... Arguments>
    explicit Input(Arguments&... arguments) : listener(arguments...) {}
    Listener listener;
    dds::DataReader<T> reader;
  };
  template <class T>
  using Watched = Input<T, observation::ObservingListener<T>>;

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

  /// Samples, fixes, reports and poses.
  template <class Sample>
  void on(const Sample& sample) {
    if (Ros2Beacon* const outputs = outputs_of(sample.address)) outputs->on(sample);
  }
  void on(const EffectiveSettings& settings);
  void on_transform(const ros2::TransformStamped& transform);

  /// The beacon's topics; null where they are not there (yet).
  Ros2Beacon* outputs_of(BeaconAddress address);
  Ros2Beacon* find_outputs(BeaconAddress address);
  template <class Action>
  void for_each_output(const Action& action);
  void make_new_outputs();
  bool is_in_tree(BeaconAddress address);
  void publish_static_transforms();
  void publish_diagnostics();
  [[nodiscard]] ros2::Diagnostic own_diagnostic(std::size_t beacons) const;
  void judge_transforms(const Ros2Beacon& outputs, ros2::Diagnostic& diagnostic) const;
  void serve(const process::StopSignal& stop, const std::atomic<bool>& failed);
  void feed_while(const std::function<void()>& serve, std::atomic<bool>& failed);
  void serve_parameters(const std::stop_token& end, const process::StopSignal& stop);

  [[nodiscard]] const std::string& node_name() const { return options_.names.node().name; }

  Ros2RelayOptions options_;
  dds::DomainParticipant participant_;
  dds::QosProvider qos_;
  ros2::Node node_;
  Ros2ParameterServer parameters_;
  dds::DataWriter<ros2::DiagnosticArray> diagnostics_writer_;
  dds::DataWriter<ros2::TFMessage> tf_writer_;
  dds::DataWriter<ros2::TFMessage> static_tf_writer_;
  std::optional<BeaconAddress> tree_owner_;  ///< whose frames they are where all have the same
  bool reported_of_tree_ = false;
  std::unique_ptr<Ros2Source> source_;  ///< of what comes in from ROS 2, if anything does
  observation::BeaconObservers watches_;
  process::EndpointCounters ends_;
  std::map<BeaconAddress, observation::BeaconView> told_;  ///< in the diagnostics of the second before

  std::mutex mutex_;                                              ///< of what follows
  std::map<BeaconAddress, std::unique_ptr<Ros2Beacon>> outputs_;  ///< null: to be made; never taken away
  std::map<BeaconAddress, EffectiveSettings> settings_in_force_;  ///< may come before anything else
  bool has_new_ = false;

  // Readers last: they go first, and no callback finds what is gone already.
  TfListener tf_listener_{*this};
  dds::DataReader<ros2::TFMessage> tf_reader_;
  Input<sonopose_ImuSample> imu_{*this};
  Input<sonopose_UltrasonicFix> fix_{*this};
  Input<sonopose_FusedPose, PoseListener> pose_{*this};
  Input<sonopose_FixReport> report_{*this};
  Input<sonopose_EffectiveSettings> settings_{*this};
  Watched<sonopose_BeaconStatus> beacon_status_{watches_, ends_};
  Watched<sonopose_FusionStatus> fusion_status_{watches_, ends_};
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

}  // namespace sonopose::ros2
