#pragma once
/// \file
/// The processes in the domain, their readers and their writers, as found by discovery (the built-in
/// topics DCPSParticipant, DCPSPublication and DCPSSubscription).

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
  std::string key;  ///< its GUID, 32 hexadecimal digits
  std::string process_name;
  std::string host_name;
  std::optional<std::uint32_t> process_id;
  std::string addresses;  ///< its locators, in the notation of Cyclone DDS
  std::vector<std::uint8_t> user_data;
};

/// A reader or a writer.
struct FoundEndpoint {
  std::string key;
  InstanceHandle handle;  ///< of a writer: as SampleInfo::publication_handle gives it
  std::string participant_key;
  std::string topic_name;
  std::string type_name;
  Qos qos;
};

/// Reads what discovery has found so far. Every member throws `Error`.
class Discovery {
public:
  /// `participant` must outlive it. `on_change` is called after every change, under the rules of a listener:
  /// it must not block, nor use this object.
  explicit Discovery(const DomainParticipant& participant, std::function<void()> on_change = {});

  /// All that currently exist, including our own.
  std::vector<FoundParticipant> participants() const;
  std::vector<FoundEndpoint> writers() const;
  std::vector<FoundEndpoint> readers() const;

  /// The key of the own participant.
  std::string own_key() const;

private:
  class BuiltinReader : public Entity {
  public:
    /// `on_change` may be null.
    BuiltinReader(const DomainParticipant& participant, dds_entity_t topic, std::function<void()>* on_change);
  };

  /// What has left the bus does not stay in memory.
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
