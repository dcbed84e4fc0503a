#include <sonopose/dds/binding/entity.hpp>
#include <sonopose/dds/binding/error.hpp>

#include <utility>

namespace sonopose::dds {

Entity::Entity(Entity&& other) noexcept
    : handle_(std::exchange(other.handle_, 0)), ownership_(other.ownership_) {}

Entity& Entity::operator=(Entity&& other) noexcept {
  if (this != &other) {
    close();
    handle_ = std::exchange(other.handle_, 0);
    ownership_ = other.ownership_;
  }
  return *this;
}

void Entity::close() noexcept {
  // Failures are harmless: at worst, deleting the participant has already deleted the entity.
  if (handle_ > 0 && ownership_ == Ownership::owned) dds_delete(handle_);
  handle_ = 0;
}

InstanceHandle Entity::instance_handle() const {
  InstanceHandle instance;
  check("dds_get_instance_handle", dds_get_instance_handle(handle_, &instance.value));
  return instance;
}

Qos Entity::qos() const {
  Qos result;
  check("dds_get_qos", dds_get_qos(handle_, result.get()));
  return result;
}

void Entity::qos(const Qos& changes) {
  check("dds_set_qos", dds_set_qos(handle_, changes.get()));
}

StatusMask Entity::status_changes() const {
  StatusMask status;
  check("dds_get_status_changes", dds_get_status_changes(handle_, &status.mask));
  return status;
}

dds_guid_t guid_of(const Entity& entity) {
  dds_guid_t guid{};
  check("dds_get_guid", dds_get_guid(entity.handle(), &guid));
  return guid;
}

}  // namespace sonopose::dds
