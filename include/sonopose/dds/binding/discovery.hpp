#pragma once
/// \file
/// The processes of the domain, their readers and writers, as found by discovery (the built-in topics
/// DCPSParticipant, DCPSPublication and DCPSSubscription).

#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/binding/qos.hpp>
#include <sonopose/dds/binding/types.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::dds {

/// A participant. Cyclone DDS announces its process; other implementations may not.
struct FoundParticipant {
  std::string key;  ///< GUID, 32 hexadecimal digits
  std::string process_name;
  std::string host_name;
  std::optional<std::uint32_t> process_id;
  std::string addresses;  ///< locators, in the notation of Cyclone DDS
  std::vector<std::uint8_t> user_data;
};

/// A reader or a writer.
struct FoundEndpoint {
  std::string key;
  InstanceHandle handle;  ///< handle; for a writer, equal to SampleInfo::publication_handle
  std::string participant_key;
  std::string topic_name;
  std::string type_name;
  Qos qos;
};

/// Reads the results of discovery. Every member throws `Error`.
class Discovery {
public:
  /// `participant` must outlive this object. `on_change` is called after every change, under the rules of a
  /// listener: it must not block or use this object.
  explicit Discovery(const DomainParticipant& participant, std::function<void()> on_change = {});

  /// All current participants, including the own one.
  std::vector<FoundParticipant> participants() const;
  std::vector<FoundEndpoint> writers() const;
  std::vector<FoundEndpoint> readers() const;

  /// Key of the own participant.
  std::string own_key() const;

private:
  class BuiltinReader : public Entity {
  public:
    /// `on_change` may be null.
    BuiltinReader(const DomainParticipant& participant, dds_entity_t topic, std::function<void()>* on_change);
  };

  /// Frees the memory of participants and endpoints that have left the bus.
  void discard_ended() const;

  dds_entity_t participant_;
  std::unique_ptr<std::function<void()>> on_change_;  ///< may be null; the readers call it
  BuiltinReader participants_;
  BuiltinReader writers_;
  BuiltinReader readers_;
};

/// A GUID as 32 hexadecimal digits.
std::string text_of(const dds_guid_t& guid);

}  // namespace sonopose::dds
