#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/waitset.hpp>

#include <algorithm>

namespace sonopose::dds {

ReadCondition::ReadCondition(dds_entity_t reader, DataState state)
    : Entity(check("dds_create_readcondition", dds_create_readcondition(reader, state.mask))) {}

bool ReadCondition::trigger_value() const {
  return check("dds_triggered", dds_triggered(handle())) > 0;
}

GuardCondition::GuardCondition()
    : Entity(check("dds_create_guardcondition", dds_create_guardcondition(DDS_CYCLONEDDS_HANDLE))) {}

void GuardCondition::trigger_value(bool triggered) {
  check("dds_set_guardcondition", dds_set_guardcondition(handle(), triggered));
}

bool GuardCondition::trigger_value() const {
  bool triggered = false;
  check("dds_read_guardcondition", dds_read_guardcondition(handle(), &triggered));
  return triggered;
}

void StatusCondition::enabled_statuses(StatusMask mask) {
  check("dds_set_status_mask", dds_set_status_mask(entity_, mask.mask));
}

StatusMask StatusCondition::enabled_statuses() const {
  StatusMask mask;
  check("dds_get_status_mask", dds_get_status_mask(entity_, &mask.mask));
  return mask;
}

bool StatusCondition::trigger_value() const {
  return check("dds_triggered", dds_triggered(entity_)) > 0;
}

WaitSet::WaitSet() : Entity(check("dds_create_waitset", dds_create_waitset(DDS_CYCLONEDDS_HANDLE))) {}

std::size_t WaitSet::wait(Duration timeout) {
  // A negative timeout is not an error: a caller that waits until a deadline may be late.
  const Duration left = std::max(timeout, Duration::zero());
  return static_cast<std::size_t>(
      check("dds_waitset_wait", dds_waitset_wait(handle(), nullptr, 0, left.count())));
}

void WaitSet::attach(dds_entity_t condition) {
  check("dds_waitset_attach", dds_waitset_attach(handle(), condition, 0));
}

void WaitSet::detach(dds_entity_t condition) {
  check("dds_waitset_detach", dds_waitset_detach(handle(), condition));
}

}  // namespace sonopose::dds
