#pragma once
/// \file
/// Conditions, and wait sets that wait for them.

#include <sonopose/dds/binding/data_reader.hpp>
#include <sonopose/dds/binding/entity.hpp>

#include <dds/dds.h>

#include <cstddef>

namespace sonopose::dds {

/// True while a reader has samples of the given state. Must not outlive the reader.
class ReadCondition : public Entity {
public:
  template <class T>
  explicit ReadCondition(const DataReader<T>& reader, DataState state = DataState::any())
      : ReadCondition(reader.handle(), state) {}

  bool trigger_value() const;

private:
  ReadCondition(dds_entity_t reader, DataState state);
};

/// True while the application sets it, to wake another thread from its `WaitSet`.
class GuardCondition : public Entity {
public:
  GuardCondition();

  void trigger_value(bool triggered);
  bool trigger_value() const;
};

/// True while one of an entity's enabled statuses has changed and was not read. It is part of the entity,
/// which has one set of enabled statuses.
class StatusCondition {
public:
  explicit StatusCondition(const Entity& entity) : entity_(entity.handle()) {}

  void enabled_statuses(StatusMask mask);
  StatusMask enabled_statuses() const;
  bool trigger_value() const;
  dds_entity_t handle() const noexcept { return entity_; }

private:
  dds_entity_t entity_;
};

/// Blocks a thread until a condition is true. Unlike in ISO C++ DDS, a timeout is a result and not an
/// exception.
class WaitSet : public Entity {
public:
  WaitSet();

  /// Attaches a `ReadCondition`, `GuardCondition` or `StatusCondition`. It leaves the set when it is
  /// destroyed.
  template <class Condition>
  WaitSet& operator+=(const Condition& condition) {
    attach(condition.handle());
    return *this;
  }
  template <class Condition>
  WaitSet& operator-=(const Condition& condition) {
    detach(condition.handle());
    return *this;
  }

  /// Returns the number of true conditions; 0 after `timeout`.
  std::size_t wait(Duration timeout = infinite);

private:
  void attach(dds_entity_t condition);
  void detach(dds_entity_t condition);
};

}  // namespace sonopose::dds
