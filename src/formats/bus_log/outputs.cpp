#include "bus_log/outputs.hpp"

#include "bus_log/decoded.hpp"
#include "bus_log/messages.hpp"

namespace sonopose::bus_log {

void for_each_output(const mcap::Reader& reader, BeaconAddress address,
                     const std::function<void(const FusedPose&)>& on_pose,
                     const std::function<void(const FixReport&)>& on_report) {
  using dds::topics::pose;
  using dds::topics::report;
  const auto is_output = [](const mcap::Channel& channel) {
    return channel.topic == pose.name || channel.topic == report.name;
  };
  require_our_types(reader, is_output);
  mcap::Selection selection;
  selection.channel = is_output;
  mcap::Messages messages(reader, selection);
  while (const auto message = messages.next()) {
    const mcap::Channel& channel = reader.channels().at(message->channel_id);
    if (beacon_of(channel, *message) != address) continue;
    if (channel.topic == pose.name) {
      on_pose(decoded(pose, reader, *message));
    } else {
      on_report(decoded(report, reader, *message));
    }
  }
}

}  // namespace sonopose::bus_log
