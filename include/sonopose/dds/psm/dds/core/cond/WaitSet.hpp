#pragma once
/// \file
/// Conditions, and wait sets that wait for them. Left out: WaitSet::wait into a given sequence, and
/// handlers that take the kind of the condition instead of Condition.

#include "../Entity.hpp"
#include "../Time.hpp"

#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace dds::inline sonopose_psm::core::cond {

class Condition;

namespace detail {
class ConditionNode : public core::detail::Node {
public:
  using Node::Node;

  std::function<void(Condition&)> handler;
};
}  // namespace detail

/// A condition of any kind.
class Condition : public Reference {
public:
  Condition(null_type) {}

  /// Sets what `dispatch` calls, with this condition.
  template <class Functor>
  void handler(Functor functor) {
    node<detail::ConditionNode>().handler = std::move(functor);
  }
  void reset_handler() { node<detail::ConditionNode>().handler = nullptr; }
  /// Calls the handler, if there is one and the condition is true.
  void dispatch() {
    const auto handler = node<detail::ConditionNode>().handler;
    if (handler && trigger_value()) handler(*this);
  }
  bool trigger_value() const;

protected:
  explicit Condition(std::shared_ptr<core::detail::Node> node) : Reference(std::move(node)) {}

private:
  friend class WaitSet;
};

/// True while one of an entity's enabled statuses has changed and was not read. An entity has one.
class StatusCondition : public Condition {
public:
  StatusCondition(null_type) : Condition(null) {}
  StatusCondition(const Entity& entity);
  template <class Functor>
  StatusCondition(const Entity& entity, Functor functor) : StatusCondition(entity) {
    handler(std::move(functor));
  }

  void enabled_statuses(const status::StatusMask& mask) const;
  const status::StatusMask enabled_statuses() const;
  const Entity entity() const { return Entity(node().owner()); }
};

/// True while the application sets it.
class GuardCondition : public Condition {
public:
  GuardCondition();
  GuardCondition(null_type) : Condition(null) {}
  template <class Functor>
  explicit GuardCondition(Functor functor) : GuardCondition() {
    handler(std::move(functor));
  }

  void trigger_value(bool value);
  bool trigger_value() { return Condition::trigger_value(); }
};

/// Blocks a thread until a condition is true. Attached conditions keep their entities: one whose listener
/// ends must be closed or detached before.
class WaitSet : public Reference {
public:
  using ConditionSeq = std::vector<Condition>;

  WaitSet();
  WaitSet(null_type) {}

  /// Calls the handlers of the conditions that are true, and returns these conditions. Throws TimeoutError
  /// after `timeout`.
  const ConditionSeq wait(const Duration& timeout);
  const ConditionSeq wait() { return wait(Duration::infinite()); }

  /// Waits, and calls once more the handlers of the conditions that are still true.
  void dispatch(const Duration& timeout);
  void dispatch() { dispatch(Duration::infinite()); }

  WaitSet& operator+=(const Condition& condition) { return attach_condition(condition); }
  WaitSet& operator-=(const Condition& condition) {
    detach_condition(condition);
    return *this;
  }
  /// A second call for a condition has no effect.
  WaitSet& attach_condition(const Condition& condition);
  /// Returns false if the condition was not attached, or is closed.
  bool detach_condition(const Condition& condition);
  const ConditionSeq conditions() const;
};

}  // namespace dds::inline sonopose_psm::core::cond
