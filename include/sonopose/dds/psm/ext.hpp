#pragma once
/// \file
/// Functions on entities of the PSM: calls that the PSM lacks, and faster ones. The hot path, the recorder,
/// the player and the ROS 2 relay use the structs of idlc as types of their topics (TopicTraits), without
/// conversions.

#include "dds/dds.hpp"
#include <sonopose/dds/binding/domain.hpp>
#include <sonopose/dds/psm/names.hpp>
#include <sonopose/dds/psm/qos.hpp>

#include <dds/dds.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace sonopose::dds {

/// Result of a Cyclone DDS call: negative is an error (`DDS_RETCODE_…`), anything else a success.
using ReturnCode = dds_return_t;

/// The enclave of this process does not permit what it tried.
struct ForbiddenError : core::IllegalOperationError {
  using IllegalOperationError::IllegalOperationError;
};

/// Returns a type under another name on the wire, without the type information, which has the old name.
inline dds_topic_descriptor_t renamed(const dds_topic_descriptor_t& descriptor, const char* type_name) {
  return {.m_size = descriptor.m_size,
          .m_align = descriptor.m_align,
          .m_flagset = descriptor.m_flagset & ~DDS_TOPIC_XTYPES_METADATA,
          .m_nkeys = descriptor.m_nkeys,
          .m_typename = type_name,
          .m_keys = descriptor.m_keys,
          .m_nops = descriptor.m_nops,
          .m_ops = descriptor.m_ops,
          .m_meta = descriptor.m_meta,
          .type_information = {},
          .type_mapping = {},
          .restrict_data_representation = descriptor.restrict_data_representation};
}

/// Makes a struct of idlc the type of a topic (TopicTraits). Use it outside of namespaces.
#define SONOPOSE_TOPIC_TYPE(type)                                             \
  template <>                                                                 \
  struct sonopose::dds::TopicTraits<type> {                                   \
    static const dds_topic_descriptor_t& descriptor() { return type##_desc; } \
  };

namespace ext {

/// The handle of an entity or condition in C, for calls that the PSM lacks. Loans by it may have at most 256
/// samples (try_take_each).
inline dds_entity_t handle(const core::Reference& entity) {
  return core::detail::Access::handle(entity);
}

/// The handle in C, without exceptions; negative for an entity that is closed or ends meanwhile, and for
/// null.
inline dds_entity_t try_handle(const core::Reference& entity) noexcept {
  return core::detail::Access::try_handle(entity);
}

/// GUID of a participant, reader or writer, unique in the domain.
dds_guid_t guid_of(const core::Entity& entity);
/// A GUID as 32 hexadecimal digits.
std::string text_of(const dds_guid_t& guid);

/// Joins a domain with these options: other networks than loopback, peers, security. Publishers and
/// subscribers have the partition of the options by default.
domain::DomainParticipant participant(const DomainOptions& options = {}, const Qos& qos = {});

/// Makes the publisher of a writer with this QoS. Its partition is that of the options, otherwise that of the
/// writer's profile.
pub::Publisher publisher_of(const domain::DomainParticipant& participant, const Qos& writer_qos);
/// Makes the subscriber of a reader with this QoS, with a partition as for publisher_of.
sub::Subscriber subscriber_of(const domain::DomainParticipant& participant, const Qos& reader_qos);

/// Longest duration; waits for ever.
inline constexpr std::chrono::nanoseconds infinite = std::chrono::nanoseconds::max();
// An infinite duration becomes `infinite`, and a negative one zero.
std::chrono::nanoseconds to_chrono(const core::Duration& duration);
core::Duration to_duration(std::chrono::nanoseconds duration);

/// Waits, and returns false after the timeout, where WaitSet::wait throws. Calls no handlers.
bool wait(const core::cond::WaitSet& waitset, std::chrono::nanoseconds timeout = infinite);

/// All statuses but some.
inline core::status::StatusMask all_but(const core::status::StatusMask& mask) {
  core::status::StatusMask all = core::status::StatusMask::all();
  all &= ~mask;
  return all;
}

// Instance and time in a sample's info.
inline bool is_alive(const sub::SampleInfo& info) {
  return info.state().instance_state() == sub::status::InstanceState::alive();
}
inline bool is_disposed(const sub::SampleInfo& info) {
  return info.state().instance_state() == sub::status::InstanceState::not_alive_disposed();
}
/// ns since the Unix epoch; not positive for an invalid time.
inline std::int64_t source_time_ns(const sub::SampleInfo& info) {
  const core::Time time = info.timestamp();
  return time == core::Time::invalid() ? 0 : time.sec() * core::detail::ns_per_s + time.nanosec();
}

/// Identity of a matched reader or writer.
struct EndpointData {
  dds_guid_t participant_key{};  ///< GUID of its participant
  std::vector<std::uint8_t> user_data;
};

/// The writers that a reader has matched, or the readers of a writer.
std::vector<core::InstanceHandle> matched_publications(const sub::AnyDataReader& reader);
std::vector<core::InstanceHandle> matched_subscriptions(const pub::AnyDataWriter& writer);
/// Empty if there is no such match any more.
std::optional<EndpointData> matched_publication_data(const sub::AnyDataReader& reader,
                                                     const core::InstanceHandle& publication);
std::optional<EndpointData> matched_subscription_data(const pub::AnyDataWriter& writer,
                                                      const core::InstanceHandle& subscription);

// The rest is for the hot path: calls named `try_…` return codes instead of throwing.

/// Writes. After DDS_RETCODE_TIMEOUT, readers blocked for max_blocking_time and the sample was not written.
template <topic::detail::Native T>
ReturnCode try_write(const pub::DataWriter<T>& writer, const std::type_identity_t<T>& sample) noexcept {
  const dds_entity_t c_writer = try_handle(writer);
  return c_writer < 0 ? c_writer : dds_write(c_writer, &sample);
}
/// Unregisters the instance, for destructors.
template <topic::detail::Native T>
ReturnCode try_unregister_instance(const pub::DataWriter<T>& writer,
                                   const std::type_identity_t<T>& key) noexcept {
  const dds_entity_t c_writer = try_handle(writer);
  return c_writer < 0 ? c_writer : dds_unregister_instance(c_writer, &key);
}

/// Repeats `attempt()`, a `try_…` call, after timeouts until `give_up()` returns true. Returns the last code.
ReturnCode retry_unless(const auto& give_up, const auto& attempt) {
  ReturnCode code = attempt();
  while (code == DDS_RETCODE_TIMEOUT && !give_up()) code = attempt();
  return code;
}

/// Asserts manual liveliness. After its lease has expired, only a write revives the writer (Cyclone DDS
/// 0.10).
inline ReturnCode try_assert_liveliness(const pub::AnyDataWriter& writer) noexcept {
  const dds_entity_t c_writer = try_handle(writer);
  return c_writer < 0 ? c_writer : dds_assert_liveliness(c_writer);
}
/// Sends pending samples if the domain batches writes (DomainOptions::batch_writes).
inline void flush(const pub::AnyDataWriter& writer) noexcept {
  const dds_entity_t c_writer = try_handle(writer);
  if (c_writer > 0) dds_write_flush(c_writer);
}
/// True if all readers acknowledged all samples within `timeout`.
bool wait_for_acknowledgments(const pub::AnyDataWriter& writer, std::chrono::nanoseconds timeout);

/// Restricts readers made with this topic from now on to samples for which `accepts(sample, argument)` is
/// true. It is called on the receive thread, before an instance is made. `argument` must outlive the readers.
/// `sample` is a struct of idlc.
void set_filter(const topic::TopicDescription& topic, bool (*accepts)(const void* sample, void* argument),
                void* argument);

/// Sets the key fields of `key` to those of an instance. Returns a negative code if it is unknown.
template <topic::detail::Native T>
ReturnCode try_key_value(const sub::DataReader<T>& reader, T& key,
                         const core::InstanceHandle& instance) noexcept {
  const dds_entity_t c_reader = try_handle(reader);
  return c_reader < 0 ? c_reader : dds_instance_get_key(c_reader, instance.c_value(), &key);
}

/// Takes all available samples, oldest first within an instance. Calls `on_data(const T&, const
/// sub::SampleInfo&)` for each sample with data, and `on_state(const T& key, const sub::SampleInfo&)` for
/// instances that were disposed of or lost their writers; only the key fields of `key` are set. Allocates
/// nothing after the first call. Returns the number of samples, or a negative return code.
template <topic::detail::Native T, class OnData, class OnState>
ReturnCode try_take_each(const sub::DataReader<T>& reader, OnData&& on_data, OnState&& on_state) {
  constexpr std::int32_t batch = 8;  // small: Cyclone DDS clears every sample of a returned loan
  constexpr std::size_t max_loan = 256;
  // Cyclone DDS 0.10 keeps the memory of a reader's largest loan. For a later, smaller one it still writes a
  // pointer for each of those samples into the caller's array. So loans by ext::handle must not be larger.
  std::array<void*, max_loan> samples;  // NOLINT(*-member-init): dds_take reads only the first
  // Samples without pointers are taken into this memory, which saves returning a loan.
  const bool is_flat = (TopicTraits<T>::descriptor().m_flagset & DDS_TOPIC_FIXED_SIZE) != 0;
  std::array<T, batch> memory{};
  const dds_entity_t c_reader = try_handle(reader);
  if (c_reader < 0) return c_reader;
  struct ReturnLoan {  // a visitor may throw
    dds_entity_t reader;
    ReturnCode count;
    void operator()(void** loaned) const {
      if (count > 0) dds_return_loan(reader, loaned, count);
    }
  };
  ReturnCode total = 0;
  ReturnCode taken = batch;
  while (taken == batch) {
    samples[0] = nullptr;
    for (std::size_t i = 0; is_flat && i < memory.size(); ++i) samples[i] = &memory[i];
    std::array<dds_sample_info_t, batch> infos;  // NOLINT(*-member-init): dds_take fills in what is used
    taken = dds_take(c_reader, samples.data(), infos.data(), batch, batch);
    if (taken <= 0) return taken < 0 ? taken : total;
    const std::unique_ptr<void*, ReturnLoan> loan{samples.data(), {c_reader, is_flat ? 0 : taken}};
    for (std::size_t i = 0; i < static_cast<std::size_t>(taken); ++i) {
      const T& data = *static_cast<const T*>(samples[i]);
      const sub::SampleInfo info(infos[i]);
      if (info.valid()) {
        on_data(data, info);
      } else {
        on_state(data, info);
      }
    }
    total += taken;
  }
  return total;
}
template <topic::detail::Native T, class OnData>
ReturnCode try_take_each(const sub::DataReader<T>& reader, OnData&& on_data) {
  return try_take_each(reader, on_data, [](const T&, const sub::SampleInfo&) {});
}

/// Like `try_take_each`, but throws on errors.
template <topic::detail::Native T, class... Visitors>
std::size_t take_each(const sub::DataReader<T>& reader, Visitors&&... visitors) {
  return static_cast<std::size_t>(core::detail::check("dds_take", try_take_each(reader, visitors...)));
}

/// Takes the samples of a reader as they arrive, and calls a function with each, which must not throw.
template <topic::detail::Native T>
class SampleListener final : public sub::NoOpDataReaderListener<T> {
public:
  using OnSample = std::function<void(const T&, const sub::SampleInfo&)>;

  explicit SampleListener(OnSample on_sample) : on_sample_(std::move(on_sample)) {}
  void on_data_available(sub::DataReader<T>& reader) noexcept override { try_take_each(reader, on_sample_); }

private:
  OnSample on_sample_;
};

}  // namespace ext

/// Period of the deadline; infinite, the DDS default, if it is not set.
inline std::chrono::nanoseconds deadline_of(const Qos& qos) {
  return ext::to_chrono(qos.policy_or_default<policy::Deadline>().period());
}

}  // namespace sonopose::dds
