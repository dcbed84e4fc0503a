#pragma once
/// \file
/// The owner of one Cyclone DDS handle: base of topics, writers, readers and conditions.

#include <sonopose/dds/binding/qos.hpp>
#include <sonopose/dds/binding/types.hpp>

#include <dds/dds.h>

namespace sonopose::dds {

/// Move-only owner of an entity. Deletion waits for running listeners of the entity, so an entity must not be
/// destroyed in its own listener.
class Entity {
public:
  Entity() noexcept = default;
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  Entity(Entity&& other) noexcept;
  Entity& operator=(Entity&& other) noexcept;
  ~Entity() { close(); }

  /// Deletes the entity now. A second call has no effect.
  void close() noexcept;

  /// True if there is no entity: default-constructed, moved from or closed.
  bool is_nil() const noexcept { return handle_ <= 0; }

  /// Cyclone DDS handle, for calls that this layer does not wrap.
  dds_entity_t handle() const noexcept { return handle_; }

  /// Identifies this entity in samples (`SampleInfo::publication_handle`) and matches.
  InstanceHandle instance_handle() const;

  /// Effective policies, including defaults.
  Qos qos() const;

  /// Changes policies that are changeable on an existing entity.
  void qos(const Qos& changes);

  /// Statuses that have changed since they were last read.
  StatusMask status_changes() const;

protected:
  enum class Ownership : bool { borrowed, owned };
  explicit Entity(dds_entity_t handle, Ownership ownership = Ownership::owned) noexcept
      : handle_(handle), ownership_(ownership) {}

private:
  dds_entity_t handle_ = 0;
  Ownership ownership_ = Ownership::owned;
};

/// GUID of a participant, reader or writer, unique in the domain.
dds_guid_t guid_of(const Entity& entity);

}  // namespace sonopose::dds
