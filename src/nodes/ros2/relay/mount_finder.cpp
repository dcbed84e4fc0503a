#include "ros2/relay/mount_finder.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace sonopose::ros2::relay {

MountFinder::MountFinder(ros2::Node& node, std::function<void()> wake)
    : wake_(std::move(wake)),
      reader_(node.make_reader<ros2::TFMessage>("/tf_static", "ros2::TfStatic", &listener_)) {}

void MountFinder::Listener::on_data_available(dds::sub::DataReader<ros2::TFMessage>& reader) noexcept {
  {
    const threads::Lock lock(finder_.mutex_);
    dds::ext::try_take_each(reader, [this](const ros2::TFMessage& message, const dds::sub::SampleInfo&) {
      finder_.mutex_.assert_held();
      if (!finder_.transforms_.add(message)) finder_.has_surplus_ = true;
    });
  }
  finder_.wake_();
}

void MountFinder::assign_to(BeaconPublishers& publishers) {
  const ros2::FrameNames& frames = publishers.frames();
  std::optional<ros2::Transform> found;
  bool has_surplus = false;
  {
    const threads::Lock lock(mutex_);
    found = transforms_.find(frames.base, frames.imu);
    has_surplus = has_surplus_;
  }
  if (has_surplus && !std::exchange(reported_, true)) {
    logging::warning(fmt::format(
        "/tf_static: some transforms are ignored: at most {} frames, with names of at most {} characters",
        ros2::StaticTransforms::max_frames, ros2::StaticTransforms::max_name_length));
  }
  if (!found) return;
  if (!publishers.set_mount({.imu_in_base_m = found->translation_m, .q_imu_to_base = found->rotation}))
    return;
  const Vector3d& p = found->translation_m;
  logging::info(fmt::format("/tf_static has {} in {} at ({:.3f}, {:.3f}, {:.3f}) m", frames.imu, frames.base,
                            p.x(), p.y(), p.z()));
}

}  // namespace sonopose::ros2::relay
