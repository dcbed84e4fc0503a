#pragma once
/// \file
/// Finds the mount of the IMU that another node publishes beside the relay, as a URDF does.

#include "ros2/relay/beacon_publishers.hpp"
#include "threads/mutex.hpp"
#include <sonopose/dds/psm/discovery.hpp>
#include <sonopose/dds/psm/ext.hpp>
#include <sonopose/ros2/messages/static_transforms.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <functional>
#include <map>
#include <set>

namespace sonopose::ros2::relay {

/// Two different transforms of one frame would alternate for the listeners, so the relay takes over that of
/// the other node. Those of other relays do not count: they would take over this one's.
class ForeignMounts {
public:
  /// Publishers of /tf_static that are observed at a time, at most.
  static constexpr std::size_t max_publishers = 64;

  /// `wake` is called on new transforms, under the rules of a listener. `node` must outlive it. Throws
  /// dds::core::Exception.
  ForeignMounts(ros2::Node& node, std::function<void()> wake);

  /// Makes room for new publishers. Main thread only.
  void forget_gone();

  /// Gives a beacon the mount that another node publishes for its frames, and logs it. Returns true if it is
  /// another one than before. Main thread only.
  bool assign_to(BeaconPublishers& publishers);

private:
  void add(const ros2::TFMessage& message, const dds::core::InstanceHandle& publisher);
  /// Publishers that are alive and no relay.
  [[nodiscard]] std::set<dds::core::InstanceHandle> robot_publishers() const;

  std::function<void()> wake_;
  dds::Discovery discovery_;
  threads::Mutex mutex_;
  std::map<dds::core::InstanceHandle, ros2::StaticTransforms> transforms_
      SONOPOSE_GUARDED_BY(mutex_);  ///< by publisher
  dds::ext::SampleListener<ros2::TFMessage> listener_{
      [this](const ros2::TFMessage& message, const dds::sub::SampleInfo& info) {
        add(message, info.publication_handle());
      }};
  dds::sub::DataReader<ros2::TFMessage> reader_;  ///< last, because its listener uses the others
};

}  // namespace sonopose::ros2::relay
