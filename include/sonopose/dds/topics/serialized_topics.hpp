#pragma once
/// \file
/// The native topics without their types, for programs that record or forward any of them.

#include <sonopose/dds/psm/serialized.hpp>
#include <sonopose/dds/qos/provider.hpp>
#include <sonopose/dds/topics/topics.hpp>
#include <sonopose/samples/samples.hpp>
#include <sonopose/samples/time.hpp>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sonopose::dds::topics {

/// A key field of an instance.
struct KeyField {
  std::string name;
  std::variant<std::uint64_t, std::string> value;

  auto operator<=>(const KeyField&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
};

/// One row of the wiring diagram (topics.hpp).
struct SerializedTopic {
  const char* name;       ///< such as "sonopose/imu"
  const char* type_name;  ///< such as "sonopose::ImuSample"
  bool has_beacon;        ///< true if the samples begin with the address of a beacon

  /// Makes a reader with the live profile, but without a deadline. `listener` must outlive it.
  SerializedReader (*make_reader)(const domain::DomainParticipant& participant, const qos::Provider& qos,
                                  sub::DataReaderListener<Serialized>* listener);
  /// Makes a writer that forwards samples of others. It has an automatic lease, and unregistering an instance
  /// does not dispose of it.
  SerializedWriter (*make_writer)(const domain::DomainParticipant& participant, const qos::Provider& qos,
                                  Delivery delivery);
  /// Shifts every time in a sample, in place. Returns false if the bytes are not of the type.
  bool (*shift_times)(std::span<std::byte> sample, TimeNs shift_ns);
  /// Fields of a serialized key, or of a sample, which begins with its key, in the order of the IDL. Empty if
  /// the bytes are neither.
  std::vector<KeyField> (*key_fields)(std::span<const std::byte> key);
  /// True if a late reader receives the latest sample of each instance.
  bool (*is_latched)(const qos::Provider& qos);
  /// True if only the strongest writer of an instance is heard.
  bool (*is_exclusive)(const qos::Provider& qos);
};

/// All topics, in the order of the diagram.
std::span<const SerializedTopic> serialized_topics();

/// Name without a leading slash and the common prefix: "imu" for "imu", "/imu", "sonopose/imu". Names that a
/// user gives are compared in this form.
std::string short_name(std::string_view topic);

/// Finds a topic by its full or short name; null if there is none.
const SerializedTopic* find_topic(const std::string& name);

/// Beacon of a sample or key of a topic with beacons; empty if the bytes are too few.
std::optional<BeaconAddress> beacon_of(std::span<const std::byte> sample);

/// Event number of an ImuSample, UltrasonicFix, PairHeading, TwistSample, FusedPose or FixReport; empty if
/// the bytes are too few.
std::optional<std::uint64_t> event_sequence_of(std::span<const std::byte> sample);

/// Status in a serialized pose; 0 if the bytes are too few.
std::uint32_t status_of_pose(std::span<const std::byte> sample);

}  // namespace sonopose::dds::topics
