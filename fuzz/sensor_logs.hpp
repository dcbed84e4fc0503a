#pragma once
/// \file
/// The promises of every reader of a recording about the events of one beacon.

#include "logging/log.hpp"
#include "recording/log_folder.hpp"
#include "support.hpp"

#include <cstddef>
#include <cstdint>

namespace sonopose::fuzz {

/// `size`: number of bytes that the log was read from.
inline void check_log(const recording::SensorLog& log, std::size_t size) {
  promise(log.events.size() <= size, "a byte gives at most one event");
  std::uint64_t sequence = 0;
  for (const Event& event : log.events) {
    promise(sequence_of(event) == ++sequence, "events are numbered from 1");
    promise(address_of(event) == log.address, "all events have the address of the log");
    promise(available_at_ns(event) > 0 && available_at_ns(event) < TimeNs{1} << 62U, "a time is below 2^62");
  }
}

/// Suppresses warnings, which any input may cause.
inline void be_quiet() {
  static const logging::Session session(logging::Level::failure);
}

}  // namespace sonopose::fuzz
