#pragma once
/// \file
/// The native topics without their types, for programs that record or forward any of them.

#include <sonopose/dds/binding/serialized.hpp>
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
#include <variant>
#include <vector>

namespace sonopose::dds::topics {

/// A key field of an instance, in the order of the IDL.
struct KeyField {
  std::string name;
  std::variant<std::uint64_t, std::string> value;

  auto operator<=>(const KeyField&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14
};

/// One row of the wiring diagram (topics.hpp).
struct SerializedTopic {
  const char* name;       ///< "sonopose/imu"
  const char* type_name;  ///< "sonopose::ImuSample"
  bool has_beacon;        ///< its samples begin with the address of a beacon
  bool has_beacon_key;    ///< and that is the whole key

  /// A reader with the live profile, but without a deadline. `listener` must outlive it.
  SerializedReader (*make_reader)(const DomainParticipant& participant, const qos::Provider& qos,
                                  DataReaderListener<Serialized>* listener);
  /// A writer that forwards what others have written: with an automatic lease, and it does not dispose of an
  /// instance that it is told to unregister.
  SerializedWriter (*make_writer)(const DomainParticipant& participant, const qos::Provider& qos,
                                  Delivery delivery);
  /// Moves every time in a sample, in place. False if the bytes are not of the type.
  bool (*shift_times)(std::span<std::byte> sample, TimeNs shift_ns);
  /// The fields of a serialized key, or of a sample, which begins with its key; empty if the bytes are
  /// neither.
  std::vector<KeyField> (*key_fields)(std::span<const std::byte> key);
  /// Whether a late reader receives the latest sample of each instance.
  bool (*is_latched)(const qos::Provider& qos);
  /// Whether only the strongest writer of an instance is heard.
  bool (*is_exclusive)(const qos::Provider& qos);
};

/// All of them, in the order of the diagram.
std::span<const SerializedTopic> serialized_topics();

/// The name without the common prefix: "imu" for "sonopose/imu" and for "imu".
std::string short_name(const std::string& topic);

/// By either name; null if there is none.
const SerializedTopic* find_topic(const std::string& name);

/// The beacon of a sample or a key of a topic with beacons; empty if the bytes are too few.
std::optional<BeaconAddress> beacon_of(std::span<const std::byte> sample);

/// The event number of a sample that has one (ImuSample, UltrasonicFix, PairHeading, FusedPose, FixReport);
/// empty if the bytes are too few.
std::optional<std::uint64_t> event_sequence_of(std::span<const std::byte> sample);

/// The status in a serialized pose; 0 if the bytes are too few.
std::uint32_t status_of_pose(std::span<const std::byte> sample);

}  // namespace sonopose::dds::topics
