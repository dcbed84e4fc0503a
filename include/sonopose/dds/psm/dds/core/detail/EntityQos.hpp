#pragma once
/// \file
/// The QoS of an entity: one value of each of its policies.

#include "../policy/CorePolicy.hpp"

#include <dds/dds.h>

#include <memory>
#include <type_traits>

namespace dds::inline sonopose_psm::core::detail {

struct DeleteQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using CQos = std::unique_ptr<dds_qos_t, DeleteQos>;

CQos make_qos();
/// A copy; empty of null.
CQos copy_of(const dds_qos_t* qos);

// Each writes a policy into a QoS in C, and throws for an invalid value.
void apply(const policy::UserData& policy, dds_qos_t* qos);
void apply(const policy::Durability& policy, dds_qos_t* qos);
void apply(const policy::Deadline& policy, dds_qos_t* qos);
void apply(const policy::LatencyBudget& policy, dds_qos_t* qos);
void apply(const policy::Lifespan& policy, dds_qos_t* qos);
void apply(const policy::Ownership& policy, dds_qos_t* qos);
void apply(const policy::OwnershipStrength& policy, dds_qos_t* qos);
void apply(const policy::Liveliness& policy, dds_qos_t* qos);
void apply(const policy::Partition& policy, dds_qos_t* qos);
void apply(const policy::Reliability& policy, dds_qos_t* qos);
void apply(const policy::History& policy, dds_qos_t* qos);
void apply(const policy::ResourceLimits& policy, dds_qos_t* qos);
void apply(const policy::WriterDataLifecycle& policy, dds_qos_t* qos);
void apply(const policy::TransportPriority& policy, dds_qos_t* qos);
void apply(const policy::DurabilityService& policy, dds_qos_t* qos);

// Each reads a policy from a QoS in C, and returns false if it is not set there.
bool read(policy::UserData& policy, const dds_qos_t* qos);
bool read(policy::Durability& policy, const dds_qos_t* qos);
bool read(policy::Deadline& policy, const dds_qos_t* qos);
bool read(policy::LatencyBudget& policy, const dds_qos_t* qos);
bool read(policy::Lifespan& policy, const dds_qos_t* qos);
bool read(policy::Ownership& policy, const dds_qos_t* qos);
bool read(policy::OwnershipStrength& policy, const dds_qos_t* qos);
bool read(policy::Liveliness& policy, const dds_qos_t* qos);
bool read(policy::Partition& policy, const dds_qos_t* qos);
bool read(policy::Reliability& policy, const dds_qos_t* qos);
bool read(policy::History& policy, const dds_qos_t* qos);
bool read(policy::ResourceLimits& policy, const dds_qos_t* qos);
bool read(policy::WriterDataLifecycle& policy, const dds_qos_t* qos);
bool read(policy::TransportPriority& policy, const dds_qos_t* qos);
bool read(policy::DurabilityService& policy, const dds_qos_t* qos);

struct TopicDefaults;

/// A policy of an entity.
template <class Policy>
struct HeldPolicy {
  Policy held;
  bool is_set = true;  ///< false if the constructor from C found it unset
};

/// QoS of the kind of entity that `Defaults` names, which also sets defaults that differ from those of the
/// policies. It inherits them, because a tuple compiles slowly.
template <class Defaults, class... Policies>
class EntityQos : HeldPolicy<Policies>... {
  template <class Policy>
  static constexpr bool has = (std::is_same_v<Policy, Policies> || ...);

public:
  EntityQos() { Defaults::apply(*this); }

  /// Takes over the policies of a topic that this kind of entity has as well.
  template <class... Others>
  EntityQos(const EntityQos<TopicDefaults, Others...>& other) : EntityQos() {
    *this = other;
  }
  template <class... Others>
  EntityQos& operator=(const EntityQos<TopicDefaults, Others...>& other) {
    (take(other.template policy<Others>()), ...);
    return *this;
  }

  template <class Policy>
  EntityQos& policy(const Policy& value) {
    static_assert(has<Policy>, "this kind of entity has no such policy");
    detail::apply(value, make_qos().get());  // throws if it is invalid
    policy<Policy>() = value;
    return *this;
  }
  template <class Policy>
  const Policy& policy() const {
    return HeldPolicy<Policy>::held;
  }
  template <class Policy>
  Policy& policy() {
    HeldPolicy<Policy>::is_set = true;
    return HeldPolicy<Policy>::held;
  }
  template <class Policy>
  EntityQos& operator<<(const Policy& value) {
    return policy(value);
  }
  template <class Policy>
  const EntityQos& operator>>(Policy& value) const {
    value = policy<Policy>();
    return *this;
  }
  bool operator==(const EntityQos& other) const {
    return ((policy<Policies>() == other.template policy<Policies>()) && ...);
  }

  /// Beyond the PSM: the QoS in C.
  CQos c_qos() const {
    CQos qos = copy_of(base_.get());
    const auto apply_set = [&](const auto& each) {
      if (each.is_set) detail::apply(each.held, qos.get());
    };
    (apply_set(static_cast<const HeldPolicy<Policies>&>(*this)), ...);
    return qos;
  }
  /// Beyond the PSM: takes over a QoS in C. What it does not set, the topic or Cyclone DDS decides.
  static EntityQos of_c(const dds_qos_t* c) {
    EntityQos qos;
    qos.base_ = copy_of(c);
    ((qos.HeldPolicy<Policies>::is_set = read(qos.HeldPolicy<Policies>::held, c)), ...);
    return qos;
  }

private:
  template <class Policy>
  void take(const Policy& value) {
    if constexpr (has<Policy>) policy<Policy>() = value;
  }

  std::shared_ptr<const dds_qos_t> base_;  ///< with policies that this kind of entity lacks in the PSM
};

struct NoDefaults {
  static void apply(auto&) {}
};
struct ParticipantDefaults : NoDefaults {};
struct TopicDefaults : NoDefaults {};
struct PublisherDefaults : NoDefaults {};
struct SubscriberDefaults : NoDefaults {};
struct ReaderDefaults : NoDefaults {};
struct WriterDefaults {
  static void apply(auto& qos) {
    qos.template policy<policy::Reliability>().kind(policy::ReliabilityKind::RELIABLE);
  }
};

}  // namespace dds::inline sonopose_psm::core::detail
