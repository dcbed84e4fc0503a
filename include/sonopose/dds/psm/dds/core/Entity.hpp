#pragma once
/// \file
/// References to entities. Copies refer to the same entity, which ends with its last reference or by
/// `close()`. Left out: delegates, casts from an Entity to its kind, WeakReference. The classes are derived
/// from Entity and AnyDataReader or AnyDataWriter; in cyclonedds-cxx they are only converted to those, so
/// code for both takes them by value or `const&`.

#include "Exception.hpp"
#include "status/Status.hpp"

#include <dds/dds.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace dds::inline sonopose_psm::core {

namespace detail {

/// An entity or condition of Cyclone DDS, and the one that it belongs to.
class Node : public std::enable_shared_from_this<Node> {
public:
  explicit Node(std::shared_ptr<Node> owner) : owner_(std::move(owner)) {}
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  virtual ~Node() = default;

  /// Makes a node. Its last reference closes it. In a callback of the node, another thread does so, since the
  /// end waits for the callback.
  template <class N, class... Arguments>
  static std::shared_ptr<N> make(Arguments&&... arguments) {
    return std::shared_ptr<N>(new N(std::forward<Arguments>(arguments)...), release);
  }

  /// The handle in C. Throws AlreadyClosedError after `close()` of this node or of one that it belongs to.
  dds_entity_t handle() const;
  /// The handle in C, without exceptions; negative after a close.
  dds_entity_t try_handle() const noexcept {
    const dds_entity_t handle = handle_;  // read once: another thread may close the entity
    const bool is_open = handle > 0 && (owner_ == nullptr || !owner_->is_closed());
    return is_open ? handle : dds_entity_t{DDS_RETCODE_ALREADY_DELETED};
  }
  /// Sets the handle, once. A callback of the entity may do so before the constructor does.
  void handle(dds_entity_t value) noexcept {
    dds_entity_t unset = 0;
    handle_.compare_exchange_strong(unset, value);
  }

  /// Throws PreconditionNotMetError if others need the entity.
  virtual void check_unused() {}
  /// Deletes the entity. A second call has no effect.
  void close() noexcept;
  bool is_closed() const noexcept { return try_handle() < 0; }

  const std::shared_ptr<Node>& owner() const noexcept { return owner_; }

  /// The status condition of the entity, while there is one.
  std::weak_ptr<Node> status_condition;

protected:
  /// Deletes the entity in C.
  virtual void end(dds_entity_t handle) noexcept { dds_delete(handle); }

private:
  friend class Pin;
  friend class RunningCallback;
  static void release(Node* node) noexcept;
  bool inherit(std::unique_ptr<Node>& node) noexcept;

  std::shared_ptr<Node> owner_;
  std::atomic<dds_entity_t> handle_ = 0;  ///< 0 until it is set, -1 when it is closed
  mutable std::atomic<std::int32_t> pins_ = 0;
  std::mutex mutex_;
  bool has_ended_ = false;                        // guarded by mutex_
  std::vector<std::unique_ptr<Node>> inherited_;  // guarded by mutex_: what callbacks may use until the end
};

/// Keeps an entity and those that it belongs to from being deleted, for a short time.
class Pin {
public:
  /// Throws AlreadyClosedError.
  explicit Pin(const Node& node);
  Pin(const Pin&) = delete;
  Pin& operator=(const Pin&) = delete;
  ~Pin() { release(); }

private:
  void release() const noexcept;
  const Node& node_;
};

/// A callback's pointer to its entity owns nothing, since the entity's end waits for the callback. This
/// returns one that owns it, if there still is an owner.
inline std::shared_ptr<Node> owning(const std::shared_ptr<Node>& node) {
  if (node == nullptr || node.use_count() > 0) return node;
  auto owner = node->weak_from_this().lock();
  return owner == nullptr ? node : owner;
}

struct Access;

}  // namespace detail

/// A reference to an entity, to a condition, or to nothing.
class Reference {
public:
  Reference(const Reference& other) : node_(detail::owning(other.node_)) {}
  Reference(Reference&& other) noexcept : node_(other.take()) {}
  // NOLINTNEXTLINE(bugprone-unhandled-self-assignment): a copy of a pointer
  Reference& operator=(const Reference& other) {
    node_ = detail::owning(other.node_);
    return *this;
  }
  Reference& operator=(Reference&& other) noexcept {
    node_ = other.take();
    return *this;
  }
  ~Reference() = default;

  bool is_nil() const noexcept { return node_ == nullptr; }
  bool operator==(const Reference& other) const noexcept { return node_ == other.node_; }
  bool operator==(null_type) const noexcept { return is_nil(); }

protected:
  Reference() = default;
  explicit Reference(std::shared_ptr<detail::Node> node) : node_(std::move(node)) {}

  /// The object referred to. Throws NullReferenceError if there is none.
  template <class N = detail::Node>
  N& node() const {
    return static_cast<N&>(*pointer());
  }
  const std::shared_ptr<detail::Node>& pointer() const {
    if (!node_) throw NullReferenceError("this reference is dds::core::null");
    return node_;
  }

private:
  friend detail::Access;

  /// Moves the reference out. That of a callback is copied.
  std::shared_ptr<detail::Node> take() noexcept {
    return node_.use_count() > 0 ? std::move(node_) : detail::owning(node_);
  }

  std::shared_ptr<detail::Node> node_;
};

namespace detail {
/// Access of the other classes to a reference.
struct Access {
  static std::shared_ptr<Node> node(const Reference& reference) { return owning(reference.pointer()); }
  /// Returns the owner of a new entity or condition. Throws AlreadyClosedError in a callback of an entity
  /// that is ending.
  static std::shared_ptr<Node> owner(const Reference& reference) {
    auto node = owning(reference.pointer());
    if (node.use_count() == 0) throw AlreadyClosedError("this entity is ending");
    return node;
  }
  static dds_entity_t handle(const Reference& reference) { return reference.pointer()->handle(); }
  static dds_entity_t try_handle(const Reference& reference) noexcept {
    return reference.is_nil() ? dds_entity_t{DDS_RETCODE_BAD_PARAMETER} : reference.node_->try_handle();
  }
};
}  // namespace detail

/// Identifies an instance, reader or writer within this process.
class InstanceHandle {
public:
  static const InstanceHandle nil() { return {}; }

  InstanceHandle() = default;
  InstanceHandle(null_type) {}
  explicit InstanceHandle(dds_instance_handle_t value) : value_(value) {}

  bool is_nil() const noexcept { return value_ == DDS_HANDLE_NIL; }
  bool operator==(const InstanceHandle&) const = default;
  bool operator<(const InstanceHandle& other) const noexcept { return value_ < other.value_; }
  bool operator>(const InstanceHandle& other) const noexcept { return other < *this; }

  /// Beyond the PSM: the handle in C.
  dds_instance_handle_t c_value() const noexcept { return value_; }

private:
  dds_instance_handle_t value_ = DDS_HANDLE_NIL;
};

/// Members of all entities.
class Entity : public Reference {
public:
  Entity(null_type) {}
  explicit Entity(std::shared_ptr<detail::Node> node) : Reference(std::move(node)) {}

  /// Has no effect: entities are enabled from the start.
  void enable() { detail::check("dds_enable", dds_enable(node().handle())); }
  /// Statuses that changed since they were last read.
  const status::StatusMask status_changes();
  const InstanceHandle instance_handle() const;
  /// Throws PreconditionNotMetError for a topic with open readers or writers. Waits for a running callback,
  /// except while another thread closes what the entity belongs to: then that close waits.
  void close() {
    node().check_unused();
    node().close();
  }
  /// Throws, as in cyclonedds-cxx 0.10.
  [[noreturn]] void retain() { throw UnsupportedError("entities cannot be retained: keep a reference"); }

protected:
  /// Reads a status, which clears its changes.
  template <class Status, class C>
  Status read_status(dds_return_t (*get)(dds_entity_t, C*)) const {
    C c{};
    detail::check("dds_get_…_status", get(node().handle(), &c));
    return Status(c);
  }
};

}  // namespace dds::inline sonopose_psm::core
