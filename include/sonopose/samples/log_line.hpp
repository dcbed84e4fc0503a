#pragma once
/// \file
/// A line of a process's log, as other processes receive it.

#ifdef DDSCXX_SONOPOSE_HPP
#error "sonopose.hpp has classes of the same names as these native samples: include one of the two"
#endif
#define DDSCXX_SONOPOSE_HPP_EXCLUDED

#include <sonopose/samples/time.hpp>

#include <cstdint>
#include <string>

namespace sonopose {

enum class LogLevel : std::uint32_t {
  debug,
  info,
  warning,
  error,
  failure  ///< reason why the process ends
};

inline namespace native {

struct LogLine {
  std::string host;              ///< name of the machine; DDS cuts it at 64 bytes
  std::uint32_t process_id = 0;  ///< id in its operating system
  std::uint64_t number = 0;      ///< counts the published lines of the process from 1; 0: not numbered
  TimeNs time_ns = 0;            ///< time of logging
  std::string program;           ///< such as "sonopose-fusion"; DDS cuts it at 64 bytes
  LogLevel level = LogLevel::info;
  std::string text;  ///< DDS cuts it at 1024 bytes

  bool operator==(const LogLine&) const = default;
};

}  // namespace native

}  // namespace sonopose
