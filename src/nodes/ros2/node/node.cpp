#include <sonopose/ros2/messages/borrow.hpp>
#include <sonopose/ros2/messages/type_hash.hpp>
#include <sonopose/ros2/node/node.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <type_traits>
#include <utility>

namespace sonopose::ros2 {
namespace {

constexpr std::uint32_t max_unread_messages = 256;
constexpr const char* discovery_profile = "ros2::Discovery";

dds::policy::UserData user_data(const std::string& text) {
  return dds::policy::UserData({text.begin(), text.end()});
}

/// The GUID, padded with zeros.
template <class Gid>
Gid gid_of(const dds_guid_t& guid) {
  Gid gid{};
  static_assert(sizeof gid.data >= sizeof guid.v);
  std::memcpy(gid.data, guid.v, sizeof guid.v);
  return gid;
}

template <class Gid>
std::vector<Gid> gids_of(const std::vector<dds_guid_t>& guids) {
  std::vector<Gid> gids;
  for (const dds_guid_t& guid : guids) gids.push_back(gid_of<Gid>(guid));
  return gids;
}

template <class Info>
void write(dds::pub::DataWriter<Info>& writer, const dds_guid_t& participant, const NodeName* node,
           const std::vector<dds_guid_t>& readers, const std::vector<dds_guid_t>& writers) {
  using Gid = decltype(Info::gid);
  using Entities = std::remove_pointer_t<decltype(Info::node_entities_info_seq._buffer)>;
  Info info{};
  info.gid = gid_of<Gid>(participant);
  auto reader_gids = gids_of<Gid>(readers);
  auto writer_gids = gids_of<Gid>(writers);
  std::vector<Entities> nodes;
  if (node != nullptr) {
    Entities& entities = nodes.emplace_back();
    // NameResolver has checked the lengths; the padding is zero.
    node->name_space.copy(entities.node_namespace, sizeof entities.node_namespace - 1);
    node->name.copy(entities.node_name, sizeof entities.node_name - 1);
    borrow_sequence(entities.reader_gid_seq, reader_gids);
    borrow_sequence(entities.writer_gid_seq, writer_gids);
  }
  borrow_sequence(info.node_entities_info_seq, nodes);
  writer.write(info);
}

/// True if a participant has a node of this name.
template <class Info>
bool has_node(const Info& info, const NodeName& node) {
  const auto& nodes = info.node_entities_info_seq;
  return std::any_of(nodes._buffer, nodes._buffer + nodes._length, [&](const auto& each) {
    return node == NodeName{.name_space = each.node_namespace, .name = each.node_name};
  });
}

}  // namespace

dds::Qos participant_qos(const std::string& enclave) {
  return dds::Qos() << user_data("enclave=" + enclave + ";");
}

Node::Node(dds::domain::DomainParticipant participant, const dds::qos::Provider& qos, NameResolver names,
           Distro layout, QosOverrides overrides)
    : participant_(std::move(participant)),
      qos_(qos),
      names_(std::move(names)),
      layout_(layout),
      overrides_(std::move(overrides)) {
  join_discovery();
}

Node::~Node() {
  try {
    write_info(nullptr);
  } catch (const std::exception&) {
    // Usually the participant is deleted next, which has the same effect.
  }
}

void Node::join_discovery() {
  const dds::Qos& writer_qos = qos_.datawriter_qos(discovery_profile);
  // Messages wait for found_namesake(), which an application may never call.
  dds::Qos reader_qos = qos_.datareader_qos(discovery_profile);
  reader_qos << dds::policy::History::KeepLast(max_unread_messages);
  discovery_ = std::monostate();  // the two layouts cannot coexist
  if (layout_ == Distro::humble) {
    discovery_ = make_discovery<HumbleParticipantEntitiesInfo>(writer_qos, reader_qos);
  } else {
    discovery_ = make_discovery<ParticipantEntitiesInfo>(with_type_hash<ParticipantEntitiesInfo>(writer_qos),
                                                         with_type_hash<ParticipantEntitiesInfo>(reader_qos));
  }
  changed_ = true;
}

template <class Info>
Node::Discovery<Info> Node::make_discovery(const dds::Qos& writer_qos, const dds::Qos& reader_qos) const {
  const dds::topic::Topic<Info> topic(participant_, discovery_topic, qos_.topic_qos(discovery_profile));
  const dds::pub::Publisher publisher(participant_, writer_qos);
  const dds::sub::Subscriber subscriber(participant_, reader_qos);
  return {dds::pub::DataWriter<Info>(publisher, topic, writer_qos),
          dds::sub::DataReader<Info>(subscriber, topic, reader_qos)};
}

bool Node::use_layout(Distro layout) {
  if (std::exchange(layout_, layout) == layout) return false;
  join_discovery();
  return true;
}

void Node::announce() {
  if (std::exchange(changed_, false)) write_info(&names_.node());
}

/// Calls `action` with writer and reader of `ros_discovery_info`.
template <class Action>
void Node::with_discovery(const Action& action) {
  const auto unless_none = [&](auto& discovery) {
    if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(discovery)>, std::monostate>)
      action(discovery);
  };
  std::visit(unless_none, discovery_);
}

/// Announces the node; null: announces that there is none.
void Node::write_info(const NodeName* node) {
  with_discovery([&](auto& discovery) {
    node == nullptr ? write(discovery.writer, dds::ext::guid_of(participant_), nullptr, {}, {})
                    : write(discovery.writer, dds::ext::guid_of(participant_), node, readers_, writers_);
  });
}

bool Node::found_namesake() {
  const dds_guid_t own = dds::ext::guid_of(participant_);
  bool found = false;
  with_discovery([&](auto& discovery) {
    dds::ext::try_take_each(discovery.reader, [&](const auto& info, const dds::sub::SampleInfo&) {
      if (std::equal(std::begin(own.v), std::end(own.v), std::begin(info.gid.data))) return;
      found = found || has_node(info, names_.node());
    });
  });
  return found;
}

void Node::remove(const dds::core::Entity& endpoint) {
  const dds_guid_t guid = dds::ext::guid_of(endpoint);
  const auto is_it = [&](const dds_guid_t& other) {
    return std::equal(std::begin(guid.v), std::end(guid.v), std::begin(other.v));
  };
  const std::size_t count = std::erase_if(readers_, is_it) + std::erase_if(writers_, is_it);
  changed_ = changed_ || count > 0;
}

void Node::add(Guids& guids, const dds::core::Entity& endpoint) {
  guids.push_back(dds::ext::guid_of(endpoint));
  changed_ = true;
}

dds::Qos Node::add_type_hash(dds::Qos qos, const char* type_name, const std::string& prefix) {
  qos << user_data(prefix + "typehash=" + type_hash(type_name) + ";");
  return qos;
}

/// Id as in rmw_cyclonedds: the participant's GUID with a counter in the last four bytes.
std::string Node::next_service_id() {
  dds_guid_t id = dds::ext::guid_of(participant_);
  ++service_count_;
  for (unsigned i = 0; i < 4; ++i) id.v[12 + i] = static_cast<std::uint8_t>(service_count_ >> (24 - 8 * i));
  std::string text = fmt::format("{:2x}", id.v[0]);
  for (std::size_t i = 1; i < sizeof id.v; ++i) text += fmt::format(".{:x}", id.v[i]);
  return "serviceid=" + text + ";";
}

std::string client_of(const std::vector<std::uint8_t>& user_data, const dds_guid_t& participant) {
  const std::string text(user_data.begin(), user_data.end());
  const std::string key = "clientid=";
  const std::size_t begin = text.find(key);
  if (begin == std::string::npos) return {std::begin(participant.v), std::end(participant.v)};
  return text.substr(begin, text.find(';', begin) - begin);
}

}  // namespace sonopose::ros2
