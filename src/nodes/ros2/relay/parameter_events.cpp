#include "ros2/relay/parameter_events.hpp"

#include "clocks/clocks.hpp"
#include "ros2/relay/parameter_messages.hpp"
#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/time.hpp>

#include <algorithm>
#include <deque>
#include <optional>
#include <vector>

namespace sonopose::ros2::relay {
namespace {

using Assignments = std::vector<SettingAssignment>;

/// The assignment of `key`; null if there is none.
const SettingAssignment* find(const Assignments& values, const std::string& key) {
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](const SettingAssignment& each) { return each.key == key; });
  return found == values.end() ? nullptr : &*found;
}

/// Messages of parameters, and the values that they borrow.
class Messages {
public:
  /// Adds a setting, unless it is unknown here because the fusion has another version.
  void add(BeaconAddress address, const SettingAssignment& setting) {
    if (!setting_named(parameter_name({address, setting.key}))) return;
    const auto value = valid_value(setting);
    if (!value) return;
    Parameter& added = parameters_.emplace_back();
    added.name = parameter_name({address, setting.key});
    added.value = value;
    messages_.push_back({ros2::borrow_string(added.name), value_message(added.value)});
  }
  [[nodiscard]] bool empty() const { return messages_.empty(); }
  template <class Sequence>
  void lend_to(Sequence& sequence) {
    ros2::borrow_sequence(sequence, messages_);
  }

private:
  struct Parameter {
    std::string name;
    std::optional<settings::SettingValue> value;
  };
  std::deque<Parameter> parameters_;  // elements keep their addresses
  std::vector<ros2::Parameter> messages_;
};

}  // namespace

ParameterEvents::ParameterEvents(ros2::Node& node)
    : node_(ros2::full_name(node.names().node())),
      writer_(node.make_writer<ros2::ParameterEvent>("/parameter_events", "ros2::ParameterEvents")) {}

void ParameterEvents::publish(const EffectiveSettings& before, const EffectiveSettings& after) {
  Messages added;
  Messages changed;
  Messages deleted;
  for (const SettingAssignment& setting : after.values) {
    const SettingAssignment* const old = find(before.values, setting.key);
    if (old == nullptr) added.add(after.address, setting);
    if (old != nullptr && old->value != setting.value) changed.add(after.address, setting);
  }
  for (const SettingAssignment& setting : before.values) {
    if (find(after.values, setting.key) == nullptr) deleted.add(before.address, setting);
  }
  if (added.empty() && changed.empty() && deleted.empty()) return;
  ros2::ParameterEvent event{};
  event.stamp = ros2::to_ros(clocks::host_now());
  event.node = ros2::borrow_string(node_);
  added.lend_to(event.new_parameters);
  changed.lend_to(event.changed_parameters);
  deleted.lend_to(event.deleted_parameters);
  dds::ext::try_write(writer_, event);
}

}  // namespace sonopose::ros2::relay
