#include "dds/qos/xml_policies.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>

namespace sonopose::dds::qos::xml {
namespace {

// Readers of one policy each. `element` is that of the policy.

void deadline(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Deadline(positive_duration(s, Parent(s, element, {"period"}).need("period")));
}

void latency_budget(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::LatencyBudget(duration(s, Parent(s, element, {"duration"}).need("duration")));
}

void lifespan(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Lifespan(positive_duration(s, Parent(s, element, {"duration"}).need("duration")));
}

void reliability(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"kind", "max_blocking_time"});
  policy::Reliability value;
  value.kind(kind_of<policy::ReliabilityKind::Type>(
      s, parent,
      {{"RELIABLE_RELIABILITY_QOS", policy::ReliabilityKind::RELIABLE},
       {"BEST_EFFORT_RELIABILITY_QOS", policy::ReliabilityKind::BEST_EFFORT}}));
  if (parent.has("max_blocking_time")) {
    value.max_blocking_time(duration(s, parent.need("max_blocking_time")));
  }
  qos << value;
}

void history(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"kind", "depth"});
  const auto kind =
      kind_of<policy::HistoryKind::Type>(s, parent,
                                         {{"KEEP_LAST_HISTORY_QOS", policy::HistoryKind::KEEP_LAST},
                                          {"KEEP_ALL_HISTORY_QOS", policy::HistoryKind::KEEP_ALL}});
  if (kind == policy::HistoryKind::KEEP_ALL) {
    if (parent.has("depth")) s.fail(parent.need("depth"), "has no meaning with KEEP_ALL_HISTORY_QOS");
    qos << policy::History::KeepAll();
  } else {
    qos << policy::History(kind, number32(s, parent.need("depth"), 1));
  }
}

void durability(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Durability(kind_of<policy::DurabilityKind::Type>(
      s, Parent(s, element, {"kind"}),
      {{"VOLATILE_DURABILITY_QOS", policy::DurabilityKind::VOLATILE},
       {"TRANSIENT_LOCAL_DURABILITY_QOS", policy::DurabilityKind::TRANSIENT_LOCAL}}));
}

void durability_service(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::DurabilityService().history_depth(
      number32(s, Parent(s, element, {"history_depth"}).need("history_depth"), 1));
}

void liveliness(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"kind", "lease_duration"});
  policy::Liveliness value;
  value.kind(kind_of<policy::LivelinessKind::Type>(
      s, parent,
      {{"AUTOMATIC_LIVELINESS_QOS", policy::LivelinessKind::AUTOMATIC},
       {"MANUAL_BY_PARTICIPANT_LIVELINESS_QOS", policy::LivelinessKind::MANUAL_BY_PARTICIPANT},
       {"MANUAL_BY_TOPIC_LIVELINESS_QOS", policy::LivelinessKind::MANUAL_BY_TOPIC}}));
  if (parent.has("lease_duration")) value.lease_duration(positive_duration(s, parent.need("lease_duration")));
  qos << value;
}

void ownership(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Ownership(
      kind_of<policy::OwnershipKind::Type>(s, Parent(s, element, {"kind"}),
                                           {{"SHARED_OWNERSHIP_QOS", policy::OwnershipKind::SHARED},
                                            {"EXCLUSIVE_OWNERSHIP_QOS", policy::OwnershipKind::EXCLUSIVE}}));
}

void ownership_strength(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::OwnershipStrength(number32(s, Parent(s, element, {"value"}).need("value"), int32_min));
}

void transport_priority(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::TransportPriority(number32(s, Parent(s, element, {"value"}).need("value"), int32_min));
}

void writer_data_lifecycle(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const pugi::xml_node value =
      Parent(s, element, {"autodispose_unregistered_instances"}).need("autodispose_unregistered_instances");
  const std::string text = text_of(s, value);
  if (text != "true" && text != "false") s.fail(value, "must be true or false, not '" + text + "'");
  qos << policy::WriterDataLifecycle(text == "true");
}

void resource_limits(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"max_samples", "max_instances", "max_samples_per_instance"});
  const auto limit = [&](const char* name) {
    if (!parent.has(name)) return core::LENGTH_UNLIMITED;
    return number32(s, parent.need(name), 1, {{"LENGTH_UNLIMITED", core::LENGTH_UNLIMITED}});
  };
  qos << policy::ResourceLimits(limit("max_samples"), limit("max_instances"),
                                limit("max_samples_per_instance"));
}

void partition(const Source& s, const pugi::xml_node& element, Qos& qos) {
  core::StringSeq value;
  const pugi::xml_node names = Parent(s, element, {"name"}).need("name");
  s.check_attributes(names, {});
  for (const pugi::xml_node child : names.children()) {
    if (std::string_view(child.name()) != "element") s.fail(child, "unknown element in <name>");
    value.push_back(text_of(s, child));
  }
  if (value.empty()) s.fail(names, "<element> is missing");
  qos << policy::Partition(value);
}

void user_data(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::UserData(base64(s, Parent(s, element, {"value"}).need("value")));
}

using Reader = void (*)(const Source&, const pugi::xml_node&, Qos&);

// The entities that a policy applies to, as bits.
enum Owner : unsigned { writer = 1, reader = 2, topic = 4, participant = 8 };

struct PolicyRow {
  const char* name;
  unsigned owners;
  Reader read;
};

constexpr std::array policies{
    PolicyRow{"deadline", writer | reader | topic, deadline},
    PolicyRow{"latency_budget", writer | reader | topic, latency_budget},
    PolicyRow{"lifespan", writer | topic, lifespan},
    PolicyRow{"reliability", writer | reader | topic, reliability},
    PolicyRow{"history", writer | reader | topic, history},
    PolicyRow{"durability", writer | reader | topic, durability},
    PolicyRow{"durability_service", writer | topic, durability_service},
    PolicyRow{"liveliness", writer | reader | topic, liveliness},
    PolicyRow{"ownership", writer | reader | topic, ownership},
    PolicyRow{"ownership_strength", writer, ownership_strength},
    PolicyRow{"resource_limits", writer | reader | topic, resource_limits},
    PolicyRow{"transport_priority", writer | topic, transport_priority},
    PolicyRow{"writer_data_lifecycle", writer, writer_data_lifecycle},
    PolicyRow{"partition", writer | reader, partition},
    PolicyRow{"user_data", writer | reader | participant, user_data},
};

unsigned owner_of(std::string_view element) {
  if (element == "datawriter_qos") return writer;
  if (element == "datareader_qos") return reader;
  return element == "topic_qos" ? topic : participant;
}

}  // namespace

void read_policies(const Source& source, const pugi::xml_node& element, Qos& qos) {
  source.check_attributes(element, {});
  const unsigned owner = owner_of(element.name());
  std::set<std::string_view> seen;
  for (const pugi::xml_node child : element.children()) {
    const std::string_view name = child.name();
    const auto* const row = std::find_if(policies.begin(), policies.end(), [&](const PolicyRow& policy) {
      return policy.name == name && (policy.owners & owner) != 0;
    });
    if (child.type() != pugi::node_element) source.fail(element, "unexpected text");
    if (row == policies.end()) {
      source.fail(child, std::string("unknown element in <") + element.name() + ">");
    }
    if (!seen.insert(name).second) source.fail(child, "occurs twice");
    row->read(source, child, qos);
  }
  check_depth(source, element, qos);
}

void check_depth(const Source& source, const pugi::xml_node& element, const Qos& qos) {
  const auto history = qos.policy<policy::History>();
  const auto limits = qos.policy<policy::ResourceLimits>();
  if (history && limits && history->kind() == policy::HistoryKind::KEEP_LAST &&
      limits->max_samples_per_instance() != core::LENGTH_UNLIMITED &&
      history->depth() > limits->max_samples_per_instance()) {
    source.fail(element, "the history is deeper than max_samples_per_instance");
  }
}

}  // namespace sonopose::dds::qos::xml
