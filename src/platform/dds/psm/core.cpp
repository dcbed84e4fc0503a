// Errors, nodes and statuses.

#include "dds/binding/error.hpp"
#include "dds/psm/masks.hpp"
#include <sonopose/dds/psm/ext.hpp>

#include <array>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
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
      throw IllegalOperationError(text);
    case DDS_RETCODE_NOT_ALLOWED_BY_SECURITY:
      throw sonopose::dds::ForbiddenError(text);
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

dds_entity_t Node::handle() const {
  const dds_entity_t handle = try_handle();
  if (handle < 0) throw AlreadyClosedError("this entity is closed");
  return handle;
}

namespace {
/// The entity of the callback that runs on this thread.
thread_local const Node* in_callback = nullptr;
}  // namespace

RunningCallback::RunningCallback(void* node, dds_entity_t handle) noexcept
    : node_(*static_cast<EndpointNode*>(node)), before_(std::exchange(in_callback, &node_)) {
  node_.handle(handle);
}

RunningCallback::~RunningCallback() {
  in_callback = before_;
}

void listen(EndpointNode& node, void* listener, const Callbacks& callbacks) {
  if (listener != nullptr) node.listener = listener;
  const dds_listener_t* const c = listener == nullptr ? nullptr : callbacks.c();
  check("dds_set_listener", dds_set_listener(node.handle(), c));  // waits for running callbacks
  node.listener = listener;
}

void Node::release(Node* pointer) noexcept {
  if (pointer == in_callback) {
    try {
      std::thread([pointer] { release(pointer); }).detach();
    } catch (const std::exception&) {
      // No thread is free: the entity stays, without its listener, until its owner ends.
      static_cast<EndpointNode*>(pointer)->listener = nullptr;
    }
    return;
  }
  std::unique_ptr<Node> node(pointer);
  node->close();
  // If closing an owner deletes the entity, its callbacks may run until the owner's end.
  for (Node* owner = node->owner_.get(); owner != nullptr && node != nullptr;) {
    Node* const next = owner->owner_.get();
    if (owner->inherit(node)) return;
    owner = next;
  }
}

bool Node::inherit(std::unique_ptr<Node>& node) noexcept {
  const std::lock_guard lock(mutex_);
  if (handle_ >= 0 || has_ended_) return false;
  try {
    inherited_.push_back(std::move(node));
  } catch (const std::bad_alloc&) {
    static_cast<void>(node.release());  // callbacks may use it until the end, so it stays
  }
  return true;
}

Pin::Pin(const Node& node) : node_(node) {
  for (const Node* each = &node; each != nullptr; each = each->owner_.get()) ++each->pins_;
  if (!node.is_closed()) return;
  release();
  throw AlreadyClosedError("this entity is closed");
}

void Pin::release() const noexcept {
  for (const Node* each = &node_; each != nullptr; each = each->owner_.get()) {
    if (--each->pins_ == 0) each->pins_.notify_all();
  }
}

void Node::close() noexcept {
  const dds_entity_t handle = handle_.exchange(-1);
  if (handle <= 0) return;
  for (std::int32_t pins = pins_; pins != 0; pins = pins_) pins_.wait(pins);
  if (owner_ == nullptr || !owner_->is_closed()) end(handle);  // otherwise the owner deletes it
  std::vector<std::unique_ptr<Node>> inherited;
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    inherited.swap(inherited_);
  }
  for (auto& node : inherited) release(node.release());
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

const status::StatusMask Entity::status_changes() {
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
