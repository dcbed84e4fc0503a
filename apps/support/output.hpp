#pragma once
/// \file
/// Flushes standard output.

namespace sonopose::apps {

/// Passes standard output to the operating system. Throws std::runtime_error with the cause of an error, even
/// of earlier output, such as a closed pipe or a full disk.
void flush_output();

}  // namespace sonopose::apps
