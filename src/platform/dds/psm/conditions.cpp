#include "dds/psm/masks.hpp"
#include <sonopose/dds/psm/dds/core/cond/WaitSet.hpp>
#include <sonopose/dds/psm/dds/sub/ddssub.hpp>

#include <algorithm>
#include <map>
#include <mutex>

namespace dds::inline sonopose_psm::core::cond {
namespace {

using core::detail::Access;
using core::detail::check;
using core::detail::Node;

class StatusConditionNode : public detail::ConditionNode {
public:
  explicit StatusConditionNode(std::shared_ptr<Node> entity) : ConditionNode(std::move(entity)) {
    handle(owner()->handle());
  }

protected:
  void end(dds_entity_t) noexcept override {}  // the handle is that of the entity
};

class WaitSetNode : public Node {
public:
  WaitSetNode() : Node(nullptr) {
    handle(check("dds_create_waitset", dds_create_waitset(DDS_CYCLONEDDS_HANDLE)));
    // dds_waitset_wait returns at once if nothing is attached.
    check("dds_waitset_attach", dds_waitset_attach(handle(), Access::handle(never_), 0));
  }

  std::mutex mutex;
  std::map<const Node*, Condition> conditions;  // guarded by mutex

private:
  GuardCondition never_;
};

/// An entity has one status condition. This makes it if there is none yet.
std::shared_ptr<Node> status_condition_of(const std::shared_ptr<Node>& entity) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  std::shared_ptr<Node> condition = entity->status_condition.lock();
  if (condition == nullptr) {
    condition = core::detail::Node::make<StatusConditionNode>(entity);
    entity->status_condition = condition;
  }
  return condition;
}

}  // namespace

bool Condition::trigger_value() const {
  return check("dds_triggered", dds_triggered(node().handle())) > 0;
}

StatusCondition::StatusCondition(const Entity& entity)
    : Condition(status_condition_of(Access::owner(entity))) {}

void StatusCondition::enabled_statuses(const status::StatusMask& mask) const {
  check("dds_set_status_mask", dds_set_status_mask(node().handle(), core::detail::to_c(mask)));
}

const status::StatusMask StatusCondition::enabled_statuses() const {
  std::uint32_t mask = 0;
  check("dds_get_status_mask", dds_get_status_mask(node().handle(), &mask));
  return core::detail::to_status_mask(mask);
}

GuardCondition::GuardCondition()
    : Condition([] {
        auto node = core::detail::Node::make<detail::ConditionNode>(nullptr);
        node->handle(check("dds_create_guardcondition", dds_create_guardcondition(DDS_CYCLONEDDS_HANDLE)));
        return node;
      }()) {}

void GuardCondition::trigger_value(bool value) {
  check("dds_set_guardcondition", dds_set_guardcondition(node().handle(), value));
}

WaitSet::WaitSet() : Reference(core::detail::Node::make<WaitSetNode>()) {}

const WaitSet::ConditionSeq WaitSet::wait(const Duration& timeout) {
  auto& waitset = node<WaitSetNode>();
  std::vector<dds_attach_t> triggered;
  {
    const std::lock_guard lock(waitset.mutex);
    triggered.resize(std::max<std::size_t>(waitset.conditions.size(), 1));
  }
  const auto count = static_cast<std::size_t>(check(
      "dds_waitset_wait",
      dds_waitset_wait(waitset.handle(), triggered.data(), triggered.size(), core::detail::to_c(timeout))));
  if (count == 0) throw TimeoutError("no condition of the wait set became true in time");
  triggered.resize(std::min(count, triggered.size()));
  ConditionSeq result;
  {
    const std::lock_guard lock(waitset.mutex);
    for (const dds_attach_t each : triggered) {
      // NOLINTNEXTLINE(performance-no-int-to-ptr): attached as a number
      const auto found = waitset.conditions.find(reinterpret_cast<const Node*>(each));
      if (found != waitset.conditions.end()) result.push_back(found->second);
    }
  }
  for (Condition& condition : result) condition.dispatch();
  return result;
}

void WaitSet::dispatch(const Duration& timeout) {
  for (Condition condition : wait(timeout)) condition.dispatch();
}

WaitSet& WaitSet::attach_condition(const Condition& condition) {
  auto& waitset = node<WaitSetNode>();
  const Node& attached = condition.node();
  const std::lock_guard lock(waitset.mutex);
  if (waitset.conditions.contains(&attached)) return *this;
  check("dds_waitset_attach",
        dds_waitset_attach(waitset.handle(), attached.handle(), reinterpret_cast<dds_attach_t>(&attached)));
  waitset.conditions.emplace(&attached, condition);
  return *this;
}

bool WaitSet::detach_condition(const Condition& condition) {
  auto& waitset = node<WaitSetNode>();
  const Node& attached = condition.node();
  const std::lock_guard lock(waitset.mutex);
  if (waitset.conditions.erase(&attached) == 0) return false;
  if (attached.is_closed()) return false;  // closing it has detached it
  check("dds_waitset_detach", dds_waitset_detach(waitset.handle(), attached.handle()));
  return true;
}

const WaitSet::ConditionSeq WaitSet::conditions() const {
  auto& waitset = node<WaitSetNode>();
  const std::lock_guard lock(waitset.mutex);
  ConditionSeq result;
  for (const auto& [attached, condition] : waitset.conditions) result.push_back(condition);
  return result;
}

}  // namespace dds::inline sonopose_psm::core::cond

namespace dds::inline sonopose_psm::sub::cond {

ReadCondition::ReadCondition(const AnyDataReader& reader, const status::DataState& state)
    : Condition([&] {
        auto node =
            core::detail::Node::make<core::cond::detail::ConditionNode>(core::detail::Access::owner(reader));
        node->handle(core::detail::check("dds_create_readcondition",
                                         dds_create_readcondition(node->owner()->handle(), state.c_mask())));
        return node;
      }()) {}

const status::DataState ReadCondition::state_filter() const {
  std::uint32_t mask = 0;
  core::detail::check("dds_get_mask", dds_get_mask(node().handle(), &mask));
  return status::DataState::of_c_mask(mask);
}

}  // namespace dds::inline sonopose_psm::sub::cond
