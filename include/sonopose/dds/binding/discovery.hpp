#pragma once
/// \file
/// Who is in the domain: the processes, and their readers and writers, as discovery tells (the built-in
/// topics DCPSParticipant, DCPSPublication and DCPSSubscription).

#include <sonopose/dds/binding/participant.hpp>
#include <sonopose/dds/binding/qos.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sonopose::dds {

/// A participant. Cyclone DDS tells of the process behind it; other implementations need not.
struct FoundParticipant {
  std::string key;  ///< its GUID, 32 hexadecimal digits
  std::string process_name;
  std::string host_name;
  std::optional<std::uint32_t> process_id;
  std::string addresses;  ///< where it receives, as Cyclone DDS writes them
  std::vector<std::uint8_t> user_data;
};

/// A reader or a writer.
struct FoundEndpoint {
  std::string key;
  std::string participant_key;
  std::string topic_name;
  std::string type_name;
  Qos qos;
};

/// Reads what discovery has found up to now. Every member throws `Error`.
class Discovery {
public:
  /// `participant` must outlive it.
  explicit Discovery(const DomainParticipant& participant);

  /// All that are there now, the own ones among them.
  std::vector<FoundParticipant> participants() const;
  std::vector<FoundEndpoint> writers() const;
  std::vector<FoundEndpoint> readers() const;

  /// The key of the own participant.
  std::string own_key() const;

private:
  class BuiltinReader : public Entity {
  public:
    BuiltinReader(const DomainParticipant& participant, dds_entity_t topic);
  };

  dds_entity_t participant_;
  BuiltinReader participants_;
  BuiltinReader writers_;
  BuiltinReader readers_;
};

/// A GUID as 32 hexadecimal digits.
std::string text_of(const dds_guid_t& guid);

}  // namespace sonopose::dds
