#pragma once
/// \file
/// Every field of a snapshot by name, to save, restore and hash it, in the order of the hash.

#include <sonopose/estimation/kalman/engine.hpp>
#include <sonopose/samples/field_fault.hpp>

#include <optional>

namespace sonopose::estimation::kalman {

/// Visits the fields of a snapshot except the counters (samples/estimator_counters.hpp).
void for_each_field(IsFieldsOf<Snapshot> auto& snapshot, const auto& visit) {
  visit("state", snapshot.history.base);
  visit("imu", snapshot.history.imu);
  visit("fixes", snapshot.history.fixes);
  visit("headings", snapshot.history.headings);
  visit("twists", snapshot.history.twists);
  visit("stamps_are_ahead", snapshot.history.stamps_are_ahead);
  visit("admission.backward_in_row", snapshot.admission.backward_in_row);
  visit("admission.announced_ns", snapshot.admission.announced_ns);
  visit("admission.ahead_in_row", snapshot.admission.ahead_in_row);
  visit("last_used_received_ns", snapshot.last_used_received_ns);
  visit("last_delay_s", snapshot.last_delay_s);
  visit("last_position_world_m", snapshot.last_position_world_m);
}

/// First field with a value that its type allows but no engine can have.
[[nodiscard]] std::optional<FieldFault> find_fault(const Snapshot& snapshot);

}  // namespace sonopose::estimation::kalman
