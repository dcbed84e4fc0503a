#pragma once
/// \file
/// Conversion of status masks from and to those of Cyclone DDS.

#include <sonopose/dds/psm/dds/core/status/Status.hpp>

#include <cstdint>

namespace dds::inline sonopose_psm::core::detail {

std::uint32_t to_c(const status::StatusMask& mask);
status::StatusMask to_status_mask(std::uint32_t c_mask);

}  // namespace dds::inline sonopose_psm::core::detail
