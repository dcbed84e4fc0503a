#include "ros2/relay/fixed_frames.hpp"

#include "clocks/clocks.hpp"
#include "logging/log.hpp"
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>
#include <vector>

namespace sonopose::ros2::relay {

FixedFrames::FixedFrames(ros2::Node& node, std::function<void()> wake)
    : wake_(std::move(wake)),
      reader_(node.make_reader<ros2::TFMessage>("/tf_static", "ros2::TfStatic", &listener_)) {}

void FixedFrames::add(const ros2::TFMessage& message) {
  {
    const threads::Lock lock(mutex_);
    if (!transforms_.add(message)) has_surplus_ = true;
  }
  if (wake_) wake_();
}

std::optional<ros2::Transform> FixedFrames::find(const std::string& in, const std::string& frame) const {
  const threads::Lock lock(mutex_);
  return transforms_.between(in, frame);
}

void FixedFrames::assign_mount_to(BeaconPublishers& publishers) {
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
  if (!found) {
    report_missing(frames);
    return;
  }
  if (!publishers.set_mount({.imu_in_base_m = found->translation_m, .q_imu_to_base = found->rotation}))
    return;
  const Vector3d& p = found->translation_m;
  logging::info(fmt::format("/tf_static has {} in {} at ({:.3f}, {:.3f}, {:.3f}) m", frames.imu, frames.base,
                            p.x(), p.y(), p.z()));
}

void FixedFrames::report_missing(const ros2::FrameNames& frames) {
  constexpr TimeNs patience_ns = 5'000'000'000;
  constexpr std::size_t max_listed = 10;
  const SteadyTime now = clocks::steady_now();
  const auto [since, is_new] = missing_since_.emplace(frames.imu, now);
  if (now - since->second < patience_ns) return;
  since->second = SteadyTime::max();  // reported
  std::vector<std::string> known;
  {
    const threads::Lock lock(mutex_);
    known = transforms_.frames(max_listed);
  }
  logging::warning(fmt::format(
      "/tf_static does not connect {} with {}, so there are no poses (--mount-from-tf): {}; --base-frame and "
      "--imu-frame name others",
      frames.imu, frames.base,
      known.empty() ? "no node has published on it"
                    : "it has " + text::escaped(fmt::format("{}", fmt::join(known, ", ")))));
}

}  // namespace sonopose::ros2::relay
