#pragma once
/// \file
/// Ends of instances on their way through the queue: the receiving thread only copies, the writing thread
/// makes text of them.

#include "mcap/chunk.hpp"
#include "recorder/instance_end.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace sonopose::recorder {

/// What comes before the key in the data of such a message. `channel_id`: of the instance's topic.
using RawEndHead = std::array<std::byte, 3>;
RawEndHead raw_end_head(std::uint16_t channel_id, bool is_disposed);

/// The name of the topic of a channel.
using TopicName = std::function<std::string(std::uint16_t channel_id)>;

/// The same messages in the same order; those of the channel of ends as text (json_of), and numbered: they
/// come from several threads. `sequence`: of the last one.
mcap::Chunk with_ends_as_text(const mcap::Chunk& chunk, std::uint16_t ends_channel_id,
                              const TopicName& topic_name, std::uint32_t& sequence);

}  // namespace sonopose::recorder
