#pragma once
/// \file
/// The simple types of dds::core.

#ifdef OMG_DDS_CORE_TYPES_HPP_
#error "this file includes the headers of cyclonedds-cxx, so it cannot include those of sonopose as well"
#endif

#include <cstdint>
#include <string>
#include <vector>

namespace dds::inline sonopose_psm::core {

using ByteSeq = std::vector<std::uint8_t>;
using StringSeq = std::vector<std::string>;

/// "No limit" of ResourceLimits and of read and take.
inline constexpr std::int32_t LENGTH_UNLIMITED = -1;

/// The type of `null`, the reference to nothing.
struct null_type {};
inline constexpr null_type null{};

}  // namespace dds::inline sonopose_psm::core
