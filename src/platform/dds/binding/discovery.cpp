#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/discovery.hpp>
#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/listener.hpp>

#include <charconv>
#include <string_view>
#include <utility>

namespace sonopose::dds {
namespace {

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

FoundParticipant found(const dds_builtintopic_participant_t& sample, InstanceHandle /*handle*/) {
  FoundParticipant participant{.key = text_of(sample.key),
                               .process_name = property(sample.qos, process_name_property),
                               .host_name = property(sample.qos, host_name_property),
                               .process_id = std::nullopt,
                               .addresses = property(sample.qos, addresses_property),
                               .user_data = {}};
  if (auto user_data = policy::UserData::from(sample.qos))
    participant.user_data = std::move(user_data->value);
  const std::string id = property(sample.qos, process_id_property);
  std::uint32_t number = 0;
  if (std::from_chars(id.data(), id.data() + id.size(), number).ec == std::errc()) {
    participant.process_id = number;
  }
  return participant;
}

/// Cyclone DDS gives an endpoint and its sample in the built-in topic the same handle.
FoundEndpoint found(const dds_builtintopic_endpoint_t& sample, InstanceHandle handle) {
  FoundEndpoint endpoint{.key = text_of(sample.key),
                         .handle = handle,
                         .participant_key = text_of(sample.participant_key),
                         .topic_name = sample.topic_name,
                         .type_name = sample.type_name,
                         .qos = {}};
  if (sample.qos != nullptr) check("dds_copy_qos", dds_copy_qos(endpoint.qos.get(), sample.qos));
  return endpoint;
}

/// Loan size for readers of built-in topics, larger than `DataReader` allows.
constexpr std::size_t max_samples = 10'000;

/// Removes ended instances from the reader of a built-in topic, which would keep them forever.
template <class Sample>
void discard_ended(dds_entity_t handle) {
  constexpr DataState ended{DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE |
                            DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE | DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE};
  detail::loan<Sample>(handle, "dds_take_mask", dds_take_mask, max_samples, max_samples, ended);
}

/// Returns the live samples, of type `Sample`, in the reader of a built-in topic.
template <class Sample>
auto all_in(dds_entity_t handle) {
  constexpr DataState alive{DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE};
  std::vector<decltype(found(std::declval<const Sample&>(), InstanceHandle{}))> result;
  for (const auto sample :
       detail::loan<Sample>(handle, "dds_read_mask", dds_read_mask, max_samples, max_samples, alive)) {
    if (sample.info().valid()) result.push_back(found(sample.data(), sample.info().instance_handle()));
  }
  return result;
}

detail::CListener change_listener(std::function<void()>* on_change) {
  if (on_change == nullptr) return nullptr;
  detail::CListener listener(dds_create_listener(on_change));
  dds_lset_data_available(listener.get(), [](dds_entity_t /*reader*/, void* arg) noexcept {
    (*static_cast<std::function<void()>*>(arg))();
  });
  return listener;
}

}  // namespace

Discovery::BuiltinReader::BuiltinReader(const DomainParticipant& participant, dds_entity_t topic,
                                        std::function<void()>* on_change)
    : Entity(
          check("dds_create_reader", "a built-in topic",
                dds_create_reader(participant.handle(), topic, nullptr, change_listener(on_change).get()))) {}

Discovery::Discovery(const DomainParticipant& participant, std::function<void()> on_change)
    : participant_(participant.handle()),
      on_change_(on_change ? std::make_unique<std::function<void()>>(std::move(on_change)) : nullptr),
      participants_(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, on_change_.get()),
      writers_(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, on_change_.get()),
      readers_(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, on_change_.get()) {}

void Discovery::discard_ended() const {
  dds::discard_ended<dds_builtintopic_participant_t>(participants_.handle());
  dds::discard_ended<dds_builtintopic_endpoint_t>(writers_.handle());
  dds::discard_ended<dds_builtintopic_endpoint_t>(readers_.handle());
}

std::vector<FoundParticipant> Discovery::participants() const {
  discard_ended();
  return all_in<dds_builtintopic_participant_t>(participants_.handle());
}

std::vector<FoundEndpoint> Discovery::writers() const {
  discard_ended();
  return all_in<dds_builtintopic_endpoint_t>(writers_.handle());
}

std::vector<FoundEndpoint> Discovery::readers() const {
  discard_ended();
  return all_in<dds_builtintopic_endpoint_t>(readers_.handle());
}

std::string Discovery::own_key() const {
  dds_guid_t guid{};
  check("dds_get_guid", dds_get_guid(participant_, &guid));
  return text_of(guid);
}

std::string text_of(const dds_guid_t& guid) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : guid.v) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

}  // namespace sonopose::dds
