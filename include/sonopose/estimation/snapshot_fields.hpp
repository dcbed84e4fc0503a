#pragma once
/// \file
/// The fields of any estimator's snapshot by name, to save, restore and hash it.

#include <sonopose/estimation/any_estimator.hpp>
#include <sonopose/estimation/documented/state_fields.hpp>
#include <sonopose/estimation/kalman/state_fields.hpp>

#include <concepts>
#include <optional>
#include <type_traits>
#include <variant>

namespace sonopose::estimation {

[[nodiscard]] inline settings::EngineKind kind_of(const AnySnapshot& snapshot) {
  return static_cast<settings::EngineKind>(snapshot.index());
}

/// Snapshot of a new estimator of this kind.
[[nodiscard]] inline AnySnapshot initial_snapshot(settings::EngineKind kind) {
  if (kind == settings::EngineKind::kalman) return kalman::Snapshot{};
  return documented::Snapshot{};
}

/// Calls `visit(name, field)` for each field of the state; `Snapshot` is AnySnapshot or const AnySnapshot.
/// Fields are bool, int, TimeNs, double, Vector3d, Quaterniond, enumerations with `choices_of`,
/// attitude::AnyFilter, and sequences of structs with their own `for_each_field`.
template <class Snapshot, class Visit>
requires std::same_as<std::remove_const_t<Snapshot>, AnySnapshot>
void for_each_field(Snapshot& snapshot, const Visit& visit) {
  std::visit([&](auto& any) { for_each_field(any, visit); }, snapshot);
}

/// Counters of a snapshot; `Snapshot` is AnySnapshot or const AnySnapshot.
template <class Snapshot>
[[nodiscard]] auto& counters_of(Snapshot& snapshot) {
  return std::visit(
      [](auto& any) -> auto& { return any.counters; }, snapshot);
}

template <class Snapshot>
[[nodiscard]] auto& reset_counter_of(Snapshot& snapshot) {
  return std::visit(
      [](auto& any) -> auto& { return any.reset_counter; }, snapshot);
}

/// First field with a value that its type allows but no estimator can have.
[[nodiscard]] inline std::optional<FieldFault> find_fault(const AnySnapshot& snapshot) {
  return std::visit([](const auto& any) { return find_fault(any); }, snapshot);
}

}  // namespace sonopose::estimation
