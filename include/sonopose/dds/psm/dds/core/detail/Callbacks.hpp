#pragma once
/// \file
/// The callbacks in C that call the listeners of readers and writers.

#include "../Entity.hpp"
#include "../status/Status.hpp"

#include <dds/dds.h>

#include <atomic>
#include <memory>

namespace dds::inline sonopose_psm::core::detail {

/// A reader or writer.
class EndpointNode : public Node {
public:
  using Node::Node;

  std::shared_ptr<Node> topic;
  std::atomic<void*> listener = nullptr;  ///< the user's listener
};

/// A callback of an entity on this thread, which must not end the entity.
class RunningCallback {
public:
  /// The entity's constructor may not have returned yet, so this gives it its handle.
  RunningCallback(void* node, dds_entity_t handle) noexcept;
  RunningCallback(const RunningCallback&) = delete;
  RunningCallback& operator=(const RunningCallback&) = delete;
  ~RunningCallback();

  void* listener() const { return node_.listener; }
  /// Does not own the entity, whose end waits for its callbacks.
  std::shared_ptr<Node> view() const { return {std::shared_ptr<void>(), &node_}; }

private:
  EndpointNode& node_;
  const Node* before_;
};

struct DeleteListener {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using CListener = std::unique_ptr<dds_listener_t, DeleteListener>;

/// The callbacks of a node for the statuses in a mask.
class Callbacks {
public:
  Callbacks(EndpointNode& node, const status::StatusMask& mask)
      : mask_(mask), c_(dds_create_listener(static_cast<void*>(&node))) {}

  template <auto method, class C>
  Callbacks& add(const status::StatusMask& status,
                 void (*set)(dds_listener_t*, void (*)(dds_entity_t, C, void*))) {
    if ((mask_ & status).any())
      set(c_.get(), [](dds_entity_t handle, C c, void* node) { call(method, handle, node, c); });
    return *this;
  }
  template <auto method>
  Callbacks& add(const status::StatusMask& status,
                 void (*set)(dds_listener_t*, void (*)(dds_entity_t, void*))) {
    if ((mask_ & status).any())
      set(c_.get(), [](dds_entity_t handle, void* node) { call(method, handle, node); });
    return *this;
  }

  const dds_listener_t* c() const { return c_.get(); }

private:
  template <class Listener, class Endpoint, class... Status, class... C>
  static void call(void (Listener::*method)(Endpoint&, const Status&...), dds_entity_t handle, void* node,
                   const C&... c) noexcept {
    const RunningCallback running(node, handle);
    auto* const listener = static_cast<Listener*>(running.listener());
    if (listener == nullptr) return;
    Endpoint endpoint(running.view());
    (listener->*method)(endpoint, Status(c)...);
  }

  status::StatusMask mask_;
  CListener c_;
};

/// Sets a listener and its callbacks; null removes them.
void listen(EndpointNode& node, void* listener, const Callbacks& callbacks);

}  // namespace dds::inline sonopose_psm::core::detail
