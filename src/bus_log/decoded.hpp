#pragma once
/// \file
/// Messages of a topic of ours as native samples.

#include "mcap/reader.hpp"
#include <sonopose/dds/binding/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <string>

namespace sonopose::bus_log {

/// Throws files::IoError that names file, message and topic.
[[noreturn]] inline void fail(const mcap::Reader& reader, const mcap::Message& message,
                              const std::string& what) {
  throw files::IoError(reader.name() + ": message " + std::to_string(message.sequence) + " of " +
                       reader.channels().at(message.channel_id).topic + " at log time " +
                       std::to_string(message.log_time_ns) + " " + what);
}

template <class T>
auto decoded(const dds::topics::Entry<T>& /*topic*/, const mcap::Reader& reader,
             const mcap::Message& message) {
  const dds::CdrSample<T> sample(message.data);
  if (sample.get() == nullptr) fail(reader, message, "is not a serialized sample of this topic");
  return dds::topics::from_idl(*sample.get());
}

}  // namespace sonopose::bus_log
