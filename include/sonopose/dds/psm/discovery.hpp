#pragma once
/// \file
/// The processes of the domain, their readers and writers, as found by discovery (the built-in topics
/// DCPSParticipant, DCPSPublication and DCPSSubscription).

#include <sonopose/dds/psm/ext.hpp>

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
  core::InstanceHandle handle;  ///< for a writer, equal to SampleInfo::publication_handle
  std::string participant_key;
  std::string topic_name;
  std::string type_name;
  Qos qos;
};

/// Reads the results of discovery. Every member throws the exceptions of the PSM.
class Discovery {
public:
  /// `on_change` is called after every change, under the rules of a listener: it must not block or use this
  /// object.
  explicit Discovery(domain::DomainParticipant participant, std::function<void()> on_change = {});
  Discovery(const Discovery&) = delete;
  Discovery& operator=(const Discovery&) = delete;
  Discovery(Discovery&&) = default;
  Discovery& operator=(Discovery&&) = delete;  // on_change_ would end before the readers that call it
  ~Discovery() = default;

  /// All current participants, including the own one.
  std::vector<FoundParticipant> participants() const;
  std::vector<FoundEndpoint> writers() const;
  std::vector<FoundEndpoint> readers() const;

  /// Key of the own participant.
  std::string own_key() const;

private:
  using Reader = std::shared_ptr<core::detail::Node>;

  Reader reader_of(dds_entity_t builtin_topic) const;
  /// Frees the memory of participants and endpoints that have left the bus.
  void discard_ended() const;

  domain::DomainParticipant participant_;
  std::unique_ptr<std::function<void()>> on_change_;  ///< may be null; the readers call it
  Reader participants_;
  Reader writers_;
  Reader readers_;
};

}  // namespace sonopose::dds
