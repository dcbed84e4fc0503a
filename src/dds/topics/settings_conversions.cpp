// The conversions of what is said about settings: the IDL types with texts and lists.

#include <sonopose/dds/topics/conversions.hpp>

#include <string>

namespace sonopose::dds {
namespace {

/// The C types know no const; a writer only reads.
char* idl(const std::string& text) {
  return const_cast<char*>(text.c_str());
}

std::string native(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

std::vector<sonopose_SettingAssignment> idl(const std::vector<SettingAssignment>& assignments) {
  std::vector<sonopose_SettingAssignment> list;
  list.reserve(assignments.size());
  for (const auto& [key, value] : assignments) list.push_back({idl(key), idl(value)});
  return list;
}

std::vector<SettingAssignment> native(const dds_sequence_sonopose_SettingAssignment& list) {
  std::vector<SettingAssignment> assignments;
  assignments.reserve(list._length);
  for (std::uint32_t i = 0; i < list._length; ++i) {
    assignments.push_back({native(list._buffer[i].key), native(list._buffer[i].value)});
  }
  return assignments;
}

}  // namespace

IdlView<sonopose_SettingsRequest> to_idl(const SettingsRequest& request) {
  return IdlView<sonopose_SettingsRequest>({.address = request.address,
                                            .request_id = request.request_id,
                                            .from_event_sequence = request.from_sequence,
                                            .assignments = {}},
                                           idl(request.assignments), &sonopose_SettingsRequest::assignments);
}

SettingsRequest from_idl(const sonopose_SettingsRequest& request) {
  return {.address = request.address,
          .request_id = request.request_id,
          .from_sequence = request.from_event_sequence,
          .assignments = native(request.assignments)};
}

IdlView<sonopose_SettingsReply> to_idl(const SettingsReply& reply) {
  return IdlView<sonopose_SettingsReply>({.address = reply.address,
                                          .request_id = reply.request_id,
                                          .accepted = reply.accepted,
                                          .reason = idl(reply.reason),
                                          .from_event_sequence = reply.from_sequence,
                                          .details = idl(reply.details)});
}

SettingsReply from_idl(const sonopose_SettingsReply& reply) {
  return {.address = reply.address,
          .request_id = reply.request_id,
          .accepted = reply.accepted,
          .reason = native(reply.reason),
          .from_sequence = reply.from_event_sequence,
          .details = native(reply.details)};
}

IdlView<sonopose_EffectiveSettings> to_idl(const EffectiveSettings& settings) {
  return IdlView<sonopose_EffectiveSettings>({.address = settings.address,
                                              .time = settings.time_ns,
                                              .from_event_sequence = settings.from_sequence,
                                              .values = {}},
                                             idl(settings.values), &sonopose_EffectiveSettings::values);
}

EffectiveSettings from_idl(const sonopose_EffectiveSettings& settings) {
  return {.address = settings.address,
          .time_ns = settings.time,
          .from_sequence = settings.from_event_sequence,
          .values = native(settings.values)};
}

}  // namespace sonopose::dds
