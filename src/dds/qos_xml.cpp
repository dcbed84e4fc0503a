#include "qos_xml.hpp"

#include <sonopose/dds/qos_provider.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <set>

namespace sonopose::dds::qos_xml {
namespace {

/// An element whose children are all known, each at most once, with no text between them.
class Parent {
public:
  Parent(const Source& source, const pugi::xml_node& element,
         std::initializer_list<std::string_view> children)
      : source_(source), element_(element) {
    source.check_attributes(element, {});
    std::set<std::string_view> seen;
    for (const pugi::xml_node child : element.children()) {
      const std::string_view name = child.name();
      if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata) {
        source.fail(element, "unexpected text '" + std::string(child.value()) + "'");
      }
      if (std::find(children.begin(), children.end(), name) == children.end()) {
        source.fail(child, std::string("unknown element in <") + element.name() + ">");
      }
      if (!seen.insert(name).second) source.fail(child, "stands twice");
    }
  }

  bool has(const char* name) const { return !element_.child(name).empty(); }

  pugi::xml_node need(const char* name) const {
    const pugi::xml_node child = element_.child(name);
    if (child.empty()) source_.fail(element_, std::string("<") + name + "> is missing");
    return child;
  }

private:
  const Source& source_;
  pugi::xml_node element_;
};

/// The text of an element that holds nothing else.
std::string text_of(const Source& source, const pugi::xml_node& element) {
  source.check_attributes(element, {});
  for (const pugi::xml_node child : element.children()) {
    if (child.type() == pugi::node_element) source.fail(child, "unknown element where a value is expected");
  }
  const std::string text = element.child_value();
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) source.fail(element, "a value is missing");
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

/// A whole number of `lowest` … `highest`, or one of the `words`.
std::int64_t number(const Source& source, const pugi::xml_node& element, std::int64_t lowest,
                    std::int64_t highest, const std::map<std::string, std::int64_t>& words = {}) {
  const std::string text = text_of(source, element);
  if (const auto word = words.find(text); word != words.end()) return word->second;
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size() || value < lowest || value > highest) {
    source.fail(element, "'" + text + "' is no whole number from " + std::to_string(lowest) + " to " +
                             std::to_string(highest));
  }
  return value;
}

constexpr std::int64_t int32_min = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t int32_max = std::numeric_limits<std::int32_t>::max();

std::int32_t number32(const Source& source, const pugi::xml_node& element, std::int64_t lowest,
                      const std::map<std::string, std::int64_t>& words = {}) {
  return static_cast<std::int32_t>(number(source, element, lowest, int32_max, words));
}

/// `<sec>` and `<nanosec>`; infinite where both that are given say so.
Duration duration(const Source& source, const pugi::xml_node& element) {
  constexpr std::int64_t forever = -1;
  const Parent parent(source, element, {"sec", "nanosec"});
  if (!parent.has("sec") && !parent.has("nanosec")) {
    source.fail(element, "a duration needs <sec>, <nanosec> or both");
  }
  std::optional<std::int64_t> seconds;
  std::optional<std::int64_t> nanoseconds;
  if (parent.has("sec")) {
    seconds = number(source, parent.need("sec"), 0, int32_max,
                     {{"DURATION_INFINITE_SEC", forever}, {"DURATION_INFINITY", forever}});
  }
  if (parent.has("nanosec")) {
    nanoseconds = number(source, parent.need("nanosec"), 0, 999'999'999,
                         {{"DURATION_INFINITE_NSEC", forever}, {"DURATION_INFINITY", forever}});
  }
  const bool infinite_sec = seconds == forever;
  const bool infinite_nsec = nanoseconds == forever;
  if ((infinite_sec && nanoseconds && !infinite_nsec) || (infinite_nsec && seconds && !infinite_sec)) {
    source.fail(element, "is half infinite");
  }
  if (infinite_sec || infinite_nsec) return infinite;
  return std::chrono::seconds(seconds.value_or(0)) + Duration(nanoseconds.value_or(0));
}

Duration positive_duration(const Source& source, const pugi::xml_node& element) {
  const Duration value = duration(source, element);
  if (value <= Duration::zero()) source.fail(element, "must be more than zero");
  return value;
}

template <class Kind>
Kind kind_of(const Source& source, const Parent& parent, const std::map<std::string, Kind>& kinds) {
  const pugi::xml_node element = parent.need("kind");
  const std::string text = text_of(source, element);
  const auto found = kinds.find(text);
  if (found == kinds.end()) {
    std::string allowed;
    for (const auto& [name, kind] : kinds) allowed += (allowed.empty() ? "" : ", ") + name;
    source.fail(element, "'" + text + "' is none of " + allowed);
  }
  return found->second;
}

std::vector<std::uint8_t> base64(const Source& source, const pugi::xml_node& element) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text = text_of(source, element);
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == '\n' || c == ' '; }),
             text.end());
  const bool whole = text.size() % 4 == 0;
  for (int i = 0; i < 2 && !text.empty() && text.back() == '='; ++i) text.pop_back();
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t value = alphabet.find(c);
    if (!whole || value == std::string_view::npos) source.fail(element, "is not base64");
    bits = (bits << 6U) | static_cast<std::uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(count)));
    }
  }
  return bytes;
}

// One function a policy. `element` is the policy's.

void deadline(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Deadline{positive_duration(s, Parent(s, element, {"period"}).need("period"))};
}

void latency_budget(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::LatencyBudget{duration(s, Parent(s, element, {"duration"}).need("duration"))};
}

void lifespan(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Lifespan{positive_duration(s, Parent(s, element, {"duration"}).need("duration"))};
}

void reliability(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"kind", "max_blocking_time"});
  policy::Reliability value;
  value.kind = kind_of<policy::ReliabilityKind>(
      s, parent,
      {{"RELIABLE_RELIABILITY_QOS", policy::ReliabilityKind::reliable},
       {"BEST_EFFORT_RELIABILITY_QOS", policy::ReliabilityKind::best_effort}});
  if (parent.has("max_blocking_time")) {
    value.max_blocking_time = duration(s, parent.need("max_blocking_time"));
  }
  qos << value;
}

void history(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"kind", "depth"});
  const auto kind = kind_of<policy::HistoryKind>(s, parent,
                                                 {{"KEEP_LAST_HISTORY_QOS", policy::HistoryKind::keep_last},
                                                  {"KEEP_ALL_HISTORY_QOS", policy::HistoryKind::keep_all}});
  if (kind == policy::HistoryKind::keep_all) {
    if (parent.has("depth")) s.fail(parent.need("depth"), "means nothing with KEEP_ALL_HISTORY_QOS");
    qos << policy::History::keep_all();
  } else {
    qos << policy::History::keep_last(number32(s, parent.need("depth"), 1));
  }
}

void durability(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Durability{kind_of<policy::DurabilityKind>(
      s, Parent(s, element, {"kind"}),
      {{"VOLATILE_DURABILITY_QOS", policy::DurabilityKind::volatile_},
       {"TRANSIENT_LOCAL_DURABILITY_QOS", policy::DurabilityKind::transient_local}})};
}

void liveliness(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"kind", "lease_duration"});
  policy::Liveliness value;
  value.kind = kind_of<policy::LivelinessKind>(
      s, parent,
      {{"AUTOMATIC_LIVELINESS_QOS", policy::LivelinessKind::automatic},
       {"MANUAL_BY_PARTICIPANT_LIVELINESS_QOS", policy::LivelinessKind::manual_by_participant},
       {"MANUAL_BY_TOPIC_LIVELINESS_QOS", policy::LivelinessKind::manual_by_topic}});
  if (parent.has("lease_duration"))
    value.lease_duration = positive_duration(s, parent.need("lease_duration"));
  qos << value;
}

void ownership(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::Ownership{
      kind_of<policy::OwnershipKind>(s, Parent(s, element, {"kind"}),
                                     {{"SHARED_OWNERSHIP_QOS", policy::OwnershipKind::shared},
                                      {"EXCLUSIVE_OWNERSHIP_QOS", policy::OwnershipKind::exclusive}})};
}

void ownership_strength(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::OwnershipStrength{number32(s, Parent(s, element, {"value"}).need("value"), int32_min)};
}

void transport_priority(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::TransportPriority{number32(s, Parent(s, element, {"value"}).need("value"), int32_min)};
}

void resource_limits(const Source& s, const pugi::xml_node& element, Qos& qos) {
  const Parent parent(s, element, {"max_samples", "max_instances", "max_samples_per_instance"});
  const auto limit = [&](const char* name) {
    if (!parent.has(name)) return policy::length_unlimited;
    return number32(s, parent.need(name), 1, {{"LENGTH_UNLIMITED", policy::length_unlimited}});
  };
  qos << policy::ResourceLimits{limit("max_samples"), limit("max_instances"),
                                limit("max_samples_per_instance")};
}

void partition(const Source& s, const pugi::xml_node& element, Qos& qos) {
  policy::Partition value;
  const pugi::xml_node names = Parent(s, element, {"name"}).need("name");
  s.check_attributes(names, {});
  for (const pugi::xml_node child : names.children()) {
    if (std::string_view(child.name()) != "element") s.fail(child, "unknown element in <name>");
    value.names.push_back(text_of(s, child));
  }
  if (value.names.empty()) s.fail(names, "<element> is missing");
  qos << value;
}

void user_data(const Source& s, const pugi::xml_node& element, Qos& qos) {
  qos << policy::UserData{base64(s, Parent(s, element, {"value"}).need("value"))};
}

using Reader = void (*)(const Source&, const pugi::xml_node&, Qos&);

// Whom a policy is for, as bits.
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
    PolicyRow{"liveliness", writer | reader | topic, liveliness},
    PolicyRow{"ownership", writer | reader | topic, ownership},
    PolicyRow{"ownership_strength", writer, ownership_strength},
    PolicyRow{"resource_limits", writer | reader | topic, resource_limits},
    PolicyRow{"transport_priority", writer | topic, transport_priority},
    PolicyRow{"partition", writer | reader, partition},
    PolicyRow{"user_data", writer | reader | participant, user_data},
};

unsigned owner_of(std::string_view element) {
  if (element == "datawriter_qos") return writer;
  if (element == "datareader_qos") return reader;
  return element == "topic_qos" ? topic : participant;
}

}  // namespace

void Source::fail_at(std::ptrdiff_t offset, const std::string& reason) const {
  const auto end = text_.begin() + std::min<std::ptrdiff_t>(std::max<std::ptrdiff_t>(offset, 0),
                                                            static_cast<std::ptrdiff_t>(text_.size()));
  const auto line = 1 + std::count(text_.begin(), end, '\n');
  throw QosFileError(name_ + ":" + std::to_string(line) + ": " + reason);
}

void Source::fail(const pugi::xml_node& element, const std::string& reason) const {
  fail_at(element.offset_debug(), std::string("<") + element.name() + ">: " + reason);
}

void Source::check_attributes(const pugi::xml_node& element,
                              std::initializer_list<std::string_view> allowed) const {
  std::set<std::string_view> seen;
  for (const pugi::xml_attribute attribute : element.attributes()) {
    const std::string_view name = attribute.name();
    const std::string quoted = "attribute '" + std::string(name) + "'";
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end()) fail(element, "unknown " + quoted);
    if (!seen.insert(name).second) fail(element, quoted + " stands twice");
  }
}

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
    if (!seen.insert(name).second) source.fail(child, "stands twice");
    row->read(source, child, qos);
  }
  const auto history = qos.policy<policy::History>();
  const auto limits = qos.policy<policy::ResourceLimits>();
  if (history && limits && history->kind == policy::HistoryKind::keep_last &&
      limits->max_samples_per_instance != policy::length_unlimited &&
      history->depth > limits->max_samples_per_instance) {
    source.fail(element, "the history is deeper than max_samples_per_instance");
  }
}

}  // namespace sonopose::dds::qos_xml
