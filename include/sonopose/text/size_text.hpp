#pragma once
/// \file
/// Numbers of bytes as a user writes and reads them.

#include <optional>
#include <string>
#include <string_view>

namespace sonopose::text {

/// Returns the bytes of "0.5MB", "2 GiB", "1e6" or "64k": 1 kB has 1000 bytes, 1 KiB 1024, in any case of
/// letters. Empty for any other text, and for a size that is negative or not finite.
std::optional<double> bytes_of(std::string_view text);

/// Returns "1 MB", "1.5 GB", "12 B": the largest unit of 1000 that it has once.
std::string size_text(double bytes);

}  // namespace sonopose::text
