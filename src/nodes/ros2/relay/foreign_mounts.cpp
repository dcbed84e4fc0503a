#include "ros2/relay/foreign_mounts.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace sonopose::ros2::relay {
namespace {

/// Differences that only rounding makes.
bool is_same(const ros2::Mount& a, const ros2::Mount& b) {
  constexpr double max_difference = 1e-6;
  return (a.imu_in_base_m - b.imu_in_base_m).norm() < max_difference &&
         a.q_imu_to_base.angularDistance(b.q_imu_to_base) < max_difference;
}

}  // namespace

ForeignMounts::ForeignMounts(ros2::Node& node, std::function<void()> wake)
    : wake_(std::move(wake)),
      discovery_(node.participant()),
      reader_(node.make_reader<ros2::TFMessage>("/tf_static", "ros2::TfStatic", &listener_)) {}

void ForeignMounts::add(const ros2::TFMessage& message, const dds::core::InstanceHandle& publisher) {
  {
    const threads::Lock lock(mutex_);
    if (transforms_.contains(publisher) || transforms_.size() < max_publishers) {
      transforms_[publisher].add(message);
    }
  }
  wake_();
}

void ForeignMounts::forget_gone() {
  std::vector<dds::core::InstanceHandle> gone;
  {
    const threads::Lock lock(mutex_);
    for (const auto& [publisher, transforms] : transforms_) gone.push_back(publisher);
  }
  if (gone.empty()) return;
  const auto matched = dds::ext::matched_publications(reader_);
  std::erase_if(gone, [&matched](const auto& each) { return std::ranges::count(matched, each) > 0; });
  const threads::Lock lock(mutex_);
  for (const dds::core::InstanceHandle publisher : gone) transforms_.erase(publisher);
}

std::set<dds::core::InstanceHandle> ForeignMounts::robot_publishers() const {
  std::set<std::string> relays{discovery_.own_key()};
  for (const dds::FoundParticipant& participant : discovery_.participants()) {
    if (participant.process_name.ends_with("sonopose-ros2")) relays.insert(participant.key);
  }
  std::set<dds::core::InstanceHandle> handles;
  for (const dds::FoundEndpoint& writer : discovery_.writers()) {
    if (!relays.contains(writer.participant_key)) handles.insert(writer.handle);
  }
  return handles;
}

bool ForeignMounts::assign_to(BeaconPublishers& publishers) {
  const ros2::FrameNames& frames = publishers.frames();
  std::vector<std::pair<dds::core::InstanceHandle, ros2::Mount>> found;
  {
    const threads::Lock lock(mutex_);
    for (const auto& [publisher, transforms] : transforms_) {
      const auto transform = transforms.find(frames.base, frames.imu);
      if (!transform) continue;
      found.emplace_back(publisher, ros2::Mount{.imu_in_base_m = transform->translation_m,
                                                .q_imu_to_base = transform->rotation});
    }
  }
  const auto known = publishers.mount();
  std::erase_if(found, [&known](const auto& each) { return known && is_same(*known, each.second); });
  if (found.empty()) return false;  // mostly, so that discovery is rarely asked
  const auto others = robot_publishers();
  const auto other =
      std::find_if(found.begin(), found.end(), [&](const auto& each) { return others.contains(each.first); });
  if (other == found.end() || !publishers.set_mount(other->second)) return false;
  const Vector3d& p = other->second.imu_in_base_m;
  logging::warning(
      fmt::format("another node publishes {} -> {} on /tf_static, at ({:.3f}, {:.3f}, {:.3f}) m: the relay "
                  "takes it over instead of its own; start it with --mount-from-tf",
                  frames.base, frames.imu, p.x(), p.y(), p.z()));
  return true;
}

}  // namespace sonopose::ros2::relay
