#pragma once
/// \file
/// The owner of one Cyclone DDS handle: base of topics, writers, readers and conditions.

#include <sonopose/dds/binding/qos.hpp>
#include <sonopose/dds/binding/types.hpp>

#include <dds/dds.h>

namespace sonopose::dds {

/// Move-only. Deleting waits until no listener of the entity is running any more, so an entity must not be
/// destroyed from within its own listener.
class Entity {
public:
  Entity() noexcept = default;
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  Entity(Entity&& other) noexcept;
  Entity& operator=(Entity&& other) noexcept;
  ~Entity() { close(); }

  /// Deletes the entity now. Nothing happens the second time.
  void close() noexcept;

  /// True where there is no entity: default made, moved from or closed.
  bool is_nil() const noexcept { return handle_ <= 0; }

  /// The Cyclone DDS handle, for calls that this layer does not wrap.
  dds_entity_t handle() const noexcept { return handle_; }

  /// Under which name samples (`SampleInfo::publication_handle`) and matches speak of this entity.
  InstanceHandle instance_handle() const;

  /// The policies in force, defaults filled in.
  Qos qos() const;

  /// Changes policies that may change while the entity lives.
  void qos(const Qos& changes);

  /// Which statuses have changed since they were read last.
  StatusMask status_changes() const;

protected:
  enum class Ownership : bool { borrowed, owned };
  explicit Entity(dds_entity_t handle, Ownership ownership = Ownership::owned) noexcept
      : handle_(handle), ownership_(ownership) {}

private:
  dds_entity_t handle_ = 0;
  Ownership ownership_ = Ownership::owned;
};

/// Under which name the whole domain knows a participant, reader or writer.
dds_guid_t guid_of(const Entity& entity);

}  // namespace sonopose::dds
