#pragma once
/// \file
/// Formats log lines for a terminal or pipe, and for the journal.

#include "logging/log.hpp"

#include <string>
#include <string_view>

namespace sonopose::logging {

/// The destination of the lines.
enum class Stream : std::uint8_t {
  text,    ///< "sonopose-fusion: warning: beacon 7: stale"
  journal  ///< "<4>beacon 7: stale"; the journal adds program and time, and shows the priority
};

/// Finds out what reads the file with this descriptor. `journal_stream`: value of the variable
/// JOURNAL_STREAM, DEVICE:INODE of the journal; null if it is not set. Source: systemd.exec(5).
Stream stream_of(int descriptor, const char* journal_stream);

/// Returns the line with its line feed. Control characters are escaped: texts name what is in files and on
/// the bus. Further lines of a text are indented, so that none looks like another entry. In the journal, each
/// has the priority. Source: sd-daemon(3).
std::string formatted(Stream stream, std::string_view program, Level level, std::string_view text);

}  // namespace sonopose::logging
