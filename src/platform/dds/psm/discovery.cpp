#include <sonopose/dds/psm/discovery.hpp>

#include <charconv>
#include <utility>

namespace sonopose::dds {
namespace {

using core::InstanceHandle;

/// Cyclone DDS's properties of a participant's process.
constexpr const char* process_name_property = "__ProcessName";
constexpr const char* process_id_property = "__Pid";
constexpr const char* host_name_property = "__Hostname";
constexpr const char* addresses_property = "__NetworkAddresses";

std::string property(const dds_qos_t* qos, const char* name) {
  char* value = nullptr;
  if (qos == nullptr || !dds_qget_prop(qos, name, &value)) return {};
  std::string text(value);
  dds_free(value);
  return text;
}

/// Returns the value of a key in "key=value;key=value;"; empty if there is none.
std::string value_in(const std::vector<std::uint8_t>& user_data, const std::string& key) {
  const std::string text = ";" + std::string(user_data.begin(), user_data.end());
  const std::string mark = ";" + key + "=";
  const std::size_t at = text.find(mark);
  if (at == text.npos) return {};
  const std::size_t begin = at + mark.size();
  return text.substr(begin, text.find(';', begin) - begin);
}

FoundParticipant found(const dds_builtintopic_participant_t& sample, InstanceHandle /*handle*/) {
  FoundParticipant participant{.key = ext::text_of(sample.key),
                               .process_name = property(sample.qos, process_name_property),
                               .host_name = property(sample.qos, host_name_property),
                               .process_id = std::nullopt,
                               .addresses = property(sample.qos, addresses_property),
                               .user_data = {}};
  policy::UserData user_data;
  if (core::detail::read(user_data, sample.qos)) participant.user_data = user_data.value();
  std::string id = property(sample.qos, process_id_property);
  if (participant.process_name.empty() && id.empty()) {  // as announced by announce_process()
    participant.process_name = value_in(participant.user_data, "process");
    participant.host_name = value_in(participant.user_data, "host");
    id = value_in(participant.user_data, "pid");
  }
  std::uint32_t number = 0;
  if (std::from_chars(id.data(), id.data() + id.size(), number).ec == std::errc()) {
    participant.process_id = number;
  }
  return participant;
}

/// Cyclone DDS gives an endpoint and its sample in the built-in topic the same handle.
FoundEndpoint found(const dds_builtintopic_endpoint_t& sample, InstanceHandle handle) {
  return {.key = ext::text_of(sample.key),
          .handle = handle,
          .participant_key = ext::text_of(sample.participant_key),
          .topic_name = sample.topic_name,
          .type_name = sample.type_name,
          .qos = Qos(sample.qos)};
}

/// Calls `visit(sample, info)` for each sample of a state in the reader of a built-in topic.
template <class Sample, class Call, class Visit>
void each_in(dds_entity_t reader, const char* name, Call call, std::uint32_t mask, const Visit& visit) {
  constexpr std::size_t max_samples = 10'000;
  std::vector<void*> samples(max_samples, nullptr);
  std::vector<dds_sample_info_t> infos(max_samples);
  const dds_return_t count =
      core::detail::check(name, call(reader, samples.data(), infos.data(), max_samples, max_samples, mask));
  const auto give_back = [&](void** first) { dds_return_loan(reader, first, count); };
  const std::unique_ptr<void*, decltype(give_back)> loan(count > 0 ? samples.data() : nullptr, give_back);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    visit(*static_cast<const Sample*>(samples[i]), infos[i]);
  }
}

/// Removes ended instances from the reader of a built-in topic, which would keep them forever.
template <class Sample>
void discard_ended_in(dds_entity_t reader) {
  constexpr std::uint32_t ended = DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE |
                                  DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE |
                                  DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE;
  each_in<Sample>(reader, "dds_take_mask", dds_take_mask, ended,
                  [](const Sample&, const dds_sample_info_t&) {});
}

/// Returns the live samples, of type `Sample`, in the reader of a built-in topic.
template <class Sample>
auto all_in(dds_entity_t reader) {
  constexpr std::uint32_t alive = DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE;
  std::vector<decltype(found(std::declval<const Sample&>(), InstanceHandle()))> result;
  each_in<Sample>(reader, "dds_read_mask", dds_read_mask, alive,
                  [&](const Sample& sample, const dds_sample_info_t& info) {
                    if (info.valid_data)
                      result.push_back(found(sample, InstanceHandle(info.instance_handle)));
                  });
  return result;
}

}  // namespace

Discovery::Discovery(domain::DomainParticipant participant, std::function<void()> on_change)
    : participant_(std::move(participant)),
      on_change_(on_change ? std::make_unique<std::function<void()>>(std::move(on_change)) : nullptr),
      participants_(reader_of(DDS_BUILTIN_TOPIC_DCPSPARTICIPANT)),
      writers_(reader_of(DDS_BUILTIN_TOPIC_DCPSPUBLICATION)),
      readers_(reader_of(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION)) {}

Discovery::Reader Discovery::reader_of(dds_entity_t builtin_topic) const {
  core::detail::CListener listener(on_change_ == nullptr ? nullptr : dds_create_listener(on_change_.get()));
  if (listener != nullptr) {
    dds_lset_data_available(listener.get(), [](dds_entity_t /*reader*/, void* arg) noexcept {
      (*static_cast<std::function<void()>*>(arg))();
    });
  }
  auto node = core::detail::Node::make<core::detail::Node>(core::detail::Access::owner(participant_));
  node->handle(core::detail::check(
      "dds_create_reader(a built-in topic)",
      dds_create_reader(ext::handle(participant_), builtin_topic, nullptr, listener.get())));
  return node;
}

void Discovery::discard_ended() const {
  discard_ended_in<dds_builtintopic_participant_t>(participants_->handle());
  discard_ended_in<dds_builtintopic_endpoint_t>(writers_->handle());
  discard_ended_in<dds_builtintopic_endpoint_t>(readers_->handle());
}

std::vector<FoundParticipant> Discovery::participants() const {
  discard_ended();
  return all_in<dds_builtintopic_participant_t>(participants_->handle());
}

std::vector<FoundEndpoint> Discovery::writers() const {
  discard_ended();
  return all_in<dds_builtintopic_endpoint_t>(writers_->handle());
}

std::vector<FoundEndpoint> Discovery::readers() const {
  discard_ended();
  return all_in<dds_builtintopic_endpoint_t>(readers_->handle());
}

std::string Discovery::own_key() const {
  return ext::text_of(ext::guid_of(participant_));
}

}  // namespace sonopose::dds
