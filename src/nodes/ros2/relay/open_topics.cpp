#include "ros2/relay/open_topics.hpp"

#include "logging/log.hpp"

#include <fmt/format.h>

#include <memory>

namespace sonopose::ros2::relay {

OpenTopics::Opened OpenTopics::open_requested(const process::StopSignal& stop) {
  Opened opened;
  for (const BeaconAddress address : context_.beacons.requested()) {
    if (stop.requested()) break;
    opened.emplace_back(address, open(address));
    context_.beacons.add(address, opened.back().second);
  }
  return opened;
}

RelayedBeacons::Publishers OpenTopics::open(BeaconAddress address) {
  const bool in_tree = context_.tree.admits(address);
  if (auto kept = context_.beacons.take_kept(address)) {
    kept->set_in_tree(in_tree);
    logging::info(fmt::format("beacon {}: found again; its topics are still open", address));
    return kept;
  }
  close_surplus();
  logging::info(fmt::format("beacon {}: found; its topics are open", address));
  return std::make_shared<BeaconPublishers>(context_.node, context_.output, address, context_.tf, in_tree,
                                            context_.wakeup);
}

std::vector<BeaconAddress> OpenTopics::remove_gone(SteadyTime now) {
  std::vector<BeaconAddress> gone;
  for (const auto& [address, kept] : context_.beacons.remove_gone(now)) {
    gone.push_back(address);
    context_.admission.forget(address);
    logging::info(fmt::format("beacon {}: gone; its topics {}", address, kept ? "stay open" : "are closed"));
  }
  close_removed();
  free_memory_.give_back(now);
  return gone;
}

/// Closes topics to make room for a new beacon.
void OpenTopics::close_surplus() {
  for (const BeaconAddress address : context_.beacons.remove_surplus()) {
    logging::info(fmt::format("beacon {}: its topics are closed: another beacon needs the place", address));
  }
  close_removed();
}

void OpenTopics::close_removed() {
  for (const auto& publishers : context_.beacons.take_unused()) {
    publishers->leave(context_.node);
    free_memory_.on_freed();
  }
}

}  // namespace sonopose::ros2::relay
