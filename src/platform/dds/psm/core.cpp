// Errors, nodes and statuses.

#include "dds/psm/masks.hpp"
#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/psm/dds/core/Entity.hpp>
#include <sonopose/dds/psm/dds/core/Time.hpp>

#include <algorithm>
#include <array>
#include <iterator>
#include <mutex>
#include <utility>
#include <vector>

namespace dds::inline sonopose_psm::core {
namespace detail {

void fail(const std::string& text, dds_return_t code) {
  switch (code) {
    case DDS_RETCODE_TIMEOUT:
      throw TimeoutError(text);
    case DDS_RETCODE_UNSUPPORTED:
      throw UnsupportedError(text);
    case DDS_RETCODE_NOT_ALLOWED:
    case DDS_RETCODE_ILLEGAL_OPERATION:
    case DDS_RETCODE_NOT_ALLOWED_BY_SECURITY:
      throw IllegalOperationError(text);
    case DDS_RETCODE_PRECONDITION_NOT_MET:
      throw PreconditionNotMetError(text);
    case DDS_RETCODE_IMMUTABLE_POLICY:
      throw ImmutablePolicyError(text);
    case DDS_RETCODE_INCONSISTENT_POLICY:
      throw InconsistentPolicyError(text);
    case DDS_RETCODE_BAD_PARAMETER:
      throw InvalidArgumentError(text);
    case DDS_RETCODE_NOT_ENOUGH_SPACE:
    case DDS_RETCODE_OUT_OF_RESOURCES:
      throw OutOfResourcesError(text);
    case DDS_RETCODE_ALREADY_DELETED:
      throw AlreadyClosedError(text);
    case DDS_RETCODE_NOT_ENABLED:
      throw NotEnabledError(text);
    default:
      throw Error(text);
  }
}

dds_return_t check(const char* call, dds_return_t code) {
  if (code < 0) fail(sonopose::dds::Error(call, code).what(), code);
  return code;
}

dds_return_t check(const char* call, const std::string& about, dds_return_t code) {
  return code < 0 ? check((std::string(call) + "(" + about + ")").c_str(), code) : code;
}

dds_time_t to_c(const Time& time) {
  if (time == Time::invalid()) throw InvalidArgumentError("the invalid time is no time stamp");
  return time.sec() * ns_per_s + time.nanosec();
}

namespace {

/// Entities that live without references.
struct Retained {
  std::mutex mutex;
  std::vector<std::shared_ptr<Node>> nodes;
};

Retained& retained() {
  static auto* const instance = new Retained;  // never destroyed: entities may be static objects
  return *instance;
}

}  // namespace

Node::~Node() {
  close();
}

dds_entity_t Node::handle() const {
  if (is_closed()) throw AlreadyClosedError("this entity is closed");
  return handle_;
}

bool Node::is_closed() const noexcept {
  return handle_ <= 0 || (owner_ != nullptr && owner_->is_closed());
}

void Node::close() noexcept {
  const bool was_closed = is_closed();  // closing the owner has deleted the entity
  const dds_entity_t handle = handle_.exchange(0);
  if (was_closed) return;
  end(handle);
  std::vector<std::shared_ptr<Node>> ended;  // end without the lock, since they close in turn
  const std::lock_guard lock(retained().mutex);
  auto& nodes = retained().nodes;
  const auto first =
      std::partition(nodes.begin(), nodes.end(), [](const auto& node) { return !node->is_closed(); });
  ended.assign(std::make_move_iterator(first), std::make_move_iterator(nodes.end()));
  nodes.erase(first, nodes.end());
}

void Node::retain() {
  const std::lock_guard lock(retained().mutex);
  retained().nodes.push_back(shared_from_this());
}

namespace {

// The bits of DDS, and those of Cyclone DDS, which leave no gaps.
constexpr std::array<std::pair<std::uint32_t, std::uint32_t>, 13> status_bits{{
    {1U << 0U, DDS_INCONSISTENT_TOPIC_STATUS},
    {1U << 1U, DDS_OFFERED_DEADLINE_MISSED_STATUS},
    {1U << 2U, DDS_REQUESTED_DEADLINE_MISSED_STATUS},
    {1U << 5U, DDS_OFFERED_INCOMPATIBLE_QOS_STATUS},
    {1U << 6U, DDS_REQUESTED_INCOMPATIBLE_QOS_STATUS},
    {1U << 7U, DDS_SAMPLE_LOST_STATUS},
    {1U << 8U, DDS_SAMPLE_REJECTED_STATUS},
    {1U << 9U, DDS_DATA_ON_READERS_STATUS},
    {1U << 10U, DDS_DATA_AVAILABLE_STATUS},
    {1U << 11U, DDS_LIVELINESS_LOST_STATUS},
    {1U << 12U, DDS_LIVELINESS_CHANGED_STATUS},
    {1U << 13U, DDS_PUBLICATION_MATCHED_STATUS},
    {1U << 14U, DDS_SUBSCRIPTION_MATCHED_STATUS},
}};

}  // namespace

std::uint32_t to_c(const status::StatusMask& mask) {
  std::uint32_t result = 0;
  for (const auto& [bit, c_bit] : status_bits) {
    if ((mask.to_ulong() & bit) != 0) result |= c_bit;
  }
  return result;
}

status::StatusMask to_status_mask(std::uint32_t c_mask) {
  std::uint32_t result = 0;
  for (const auto& [bit, c_bit] : status_bits) {
    if ((c_mask & c_bit) != 0) result |= bit;
  }
  return status::StatusMask(result);
}

}  // namespace detail

namespace status {

const InstanceHandle SampleRejectedStatus::last_instance_handle() const {
  return InstanceHandle(c_.last_instance_handle);
}
const InstanceHandle LivelinessChangedStatus::last_publication_handle() const {
  return InstanceHandle(c_.last_publication_handle);
}
template <class C>
const InstanceHandle DeadlineMissedStatus<C>::last_instance_handle() const {
  return InstanceHandle(this->c_.last_instance_handle);
}
template class DeadlineMissedStatus<dds_offered_deadline_missed_status_t>;
template class DeadlineMissedStatus<dds_requested_deadline_missed_status_t>;
const InstanceHandle PublicationMatchedStatus::last_subscription_handle() const {
  return InstanceHandle(c_.last_subscription_handle);
}
const InstanceHandle SubscriptionMatchedStatus::last_publication_handle() const {
  return InstanceHandle(c_.last_publication_handle);
}

}  // namespace status

const status::StatusMask Entity::status_changes() const {
  std::uint32_t mask = 0;
  detail::check("dds_get_status_changes", dds_get_status_changes(node().handle(), &mask));
  return detail::to_status_mask(mask);
}

const InstanceHandle Entity::instance_handle() const {
  dds_instance_handle_t instance = DDS_HANDLE_NIL;
  detail::check("dds_get_instance_handle", dds_get_instance_handle(node().handle(), &instance));
  return InstanceHandle(instance);
}

}  // namespace dds::inline sonopose_psm::core
