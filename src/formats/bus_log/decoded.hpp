#pragma once
/// \file
/// Decodes messages of native topics.

#include "mcap/reader.hpp"
#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <functional>
#include <string>

namespace sonopose::bus_log {

/// Throws files::IoError that names file, message and topic.
[[noreturn]] inline void fail(const mcap::Reader& reader, const mcap::Message& message,
                              const std::string& what) {
  throw files::IoError(reader.name() + ": message " + std::to_string(message.sequence) + " of " +
                       reader.channels().at(message.channel_id).topic + " at log time " +
                       std::to_string(message.log_time_ns) + " " + what);
}

/// Returns true if the channel of a native topic has the topic's type in this version of the program. A
/// schema without text is not compared.
bool has_our_type(const mcap::Reader& reader, const mcap::Channel& channel);

/// "FILE: topic TOPIC has another type than TYPE of this version of the program".
std::string other_type_text(const mcap::Reader& reader, const mcap::Channel& channel);

/// Throws files::IoError unless the selected channels, all of native topics, have their types, in CDR.
void require_our_types(const mcap::Reader& reader, const std::function<bool(const mcap::Channel&)>& selected);

template <class T>
auto decoded(const dds::topics::Entry<T>& /*topic*/, const mcap::Reader& reader,
             const mcap::Message& message) {
  const dds::CdrSample<T> sample(message.data);
  if (sample.get() == nullptr) fail(reader, message, "is not a serialized sample of this topic");
  return dds::topics::from_idl(*sample.get());
}

}  // namespace sonopose::bus_log
