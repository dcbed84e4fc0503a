#pragma once
/// \file
/// Standard output.

namespace sonopose::apps {

/// Passes standard output to the operating system. Throws std::runtime_error with the cause, such as a closed
/// pipe or a full disk, also of an earlier output.
void flush_output();

}  // namespace sonopose::apps
