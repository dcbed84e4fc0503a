#pragma once
/// \file
/// Ends of instances in the queue: the receive thread only copies them, the writing thread turns them into
/// text.

#include "bus_log/instance_end.hpp"
#include "mcap/chunk.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace sonopose::recorder {

/// Prefix of the key in the data of such a message. `channel_id`: channel of the instance's topic.
using RawEndHead = std::array<std::byte, 3>;
RawEndHead raw_end_head(std::uint16_t channel_id, bool is_disposed);

/// Returns the topic of a channel.
using TopicName = std::function<std::string(std::uint16_t channel_id)>;

/// Copies messages in order. Ends become text (json_of) and are numbered, since they come from several
/// threads. `sequence`: number of the last one.
mcap::Chunk with_ends_as_text(const mcap::Chunk& chunk, std::uint16_t ends_channel_id,
                              const TopicName& topic_name, std::uint32_t& sequence);

}  // namespace sonopose::recorder
