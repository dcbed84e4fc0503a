#include "bus_log/decoded.hpp"

#include "mcap/omg_idl.hpp"
#include <sonopose/dds/topics/serialized_topics.hpp>
#include <sonopose/idl/text.hpp>
#include <sonopose/text/escaped.hpp>

#include <fmt/format.h>

namespace sonopose::bus_log {

bool has_our_type(const mcap::Reader& reader, const mcap::Channel& channel) {
  const auto schema = reader.schemas().find(channel.schema_id);
  if (schema == reader.schemas().end() || schema->second.data.empty()) return true;
  const std::string type = dds::topics::find_topic(channel.topic)->type_name;
  return mcap::definition_in(schema->second.data, type) == mcap::definition_in(idl::text, type);
}

std::string other_type_text(const mcap::Reader& reader, const mcap::Channel& channel) {
  return fmt::format("{}: topic {} has another type than {} of this version of the program", reader.name(),
                     channel.topic, dds::topics::find_topic(channel.topic)->type_name);
}

void require_our_types(const mcap::Reader& reader,
                       const std::function<bool(const mcap::Channel&)>& selected) {
  for (const auto& [id, channel] : reader.channels()) {
    if (!selected(channel)) continue;
    if (channel.message_encoding != "cdr") {
      throw files::IoError(fmt::format(R"({}: topic {} has message encoding "{}" instead of "cdr")",
                                       reader.name(), text::escaped(channel.topic),
                                       text::escaped(channel.message_encoding)));
    }
    if (!has_our_type(reader, channel)) throw files::IoError(other_type_text(reader, channel));
  }
}

}  // namespace sonopose::bus_log
