#include "fusion/fusion_node_impl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

namespace sonopose::fusion {

void FusionNode::Impl::watch() {
  const SteadyTime now = process::steady_now();
  output_.watch(now, working_);
  silence_changes_.clear();
  {
    const std::lock_guard lock(estimators_mutex_);
    imu_silences_.find_changes(now, silence_changes_);
  }
  for (const auto& change : silence_changes_) publish_status(change.address);
}

void FusionNode::Impl::hand_over() {
  output_.hand_over();
  if (!output_.is_standby()) return;
  constexpr TimeNs longest_ns = 1'000'000'000;  // of a profile with a long lease, or without one
  const SteadyTime until = process::steady_now() + std::min(output_.lease_ns(), longest_ns);
  for (SteadyTime now = process::steady_now(); now < until; now = process::steady_now()) {
    watch();
    std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(watch_by(), until) - now));
  }
}

void FusionNode::Impl::publish_statuses() {
  std::vector<BeaconAddress> addresses;
  {
    const std::lock_guard lock(estimators_mutex_);
    addresses = estimators_.addresses();
  }
  for (const BeaconAddress address : addresses) publish_status(address);
  if (lossless_) log_gaps();
  log_unwritten();
  log_incompatible();
}

void FusionNode::Impl::publish_status(BeaconAddress address) {
  std::optional<FusionStatus> status;
  InputCounters inputs;
  {
    const std::lock_guard lock(estimators_mutex_);
    status = estimators_.status(address);
    if (!status) return;
    status->imu_silent = imu_silences_.is_silent(address);
    inputs = inputs_.counters(address);
  }
  status->fusion_id = id_;
  status->time_ns = process::host_now();
  status->role = output_.role(address);
  status->strength = output_.strength();
  status->imu_deadlines_missed = inputs.imu_deadlines_missed;
  status->fix_deadlines_missed = inputs.fix_deadlines_missed;
  status->heading_deadlines_missed = inputs.heading_deadlines_missed;
  status->bridge_losses = inputs.bridge_losses;
  status->pose_deadlines_missed = ends_.offered_deadlines_missed;
  status->liveliness_lost = ends_.liveliness_lost;
  status->samples_lost = ends_.samples_lost;
  status->samples_rejected = ends_.samples_rejected;
  status->incompatible_qos = ends_.incompatible_qos;
  status->poses_unwritten = unwritten_ + output_.unwritten();
  if (status_writer_.try_write(dds::to_idl(*status)) < 0) ++unwritten_;
}

void FusionNode::Impl::log_unwritten() {
  const std::uint64_t unwritten = unwritten_ + output_.unwritten();
  if (unwritten == unwritten_reported_) return;
  fmt::print(stderr, "sonopose-fusion: {} poses or reports could not be written: a consumer is too slow\n",
             unwritten - unwritten_reported_);
  unwritten_reported_ = unwritten;
}

void FusionNode::Impl::log_incompatible() {
  const std::uint64_t incompatible = ends_.incompatible_qos;
  if (incompatible == incompatible_reported_) return;
  fmt::print(stderr,
             "sonopose-fusion: {} readers or writers ask for QoS that does not go with its own; "
             "sonopose-doctor tells which\n",
             incompatible - incompatible_reported_);
  incompatible_reported_ = incompatible;
}

void FusionNode::Impl::log_gaps() {
  if (waited_for_consumer_.exchange(false)) gaps_.start_over();
  std::vector<std::string> texts;
  {
    const std::lock_guard lock(estimators_mutex_);
    for (const BeaconAddress address : estimators_.addresses()) {
      if (auto text = gaps_.on(address, estimators_.gap(address), process::steady_now()))
        texts.push_back(*std::move(text));
    }
  }
  for (const std::string& text : texts) fmt::print(stderr, "sonopose-fusion: {}\n", text);
}

}  // namespace sonopose::fusion
