#pragma once
/// \file
/// Messages about refused requests, for the client and the log.

#include "web/http/access.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace sonopose::web::http {

/// Reason for the client; empty if allowed.
std::string reason_of(Verdict verdict);

/// Start of a client's text, without anything that a terminal could take for a command.
std::string printable(std::string_view text);

/// Logs refused requests, at most one line in ten seconds.
class RefusalLog {
public:
  void add(Verdict verdict, const Credentials& credentials);
  void add(const std::string& line);

private:
  std::chrono::steady_clock::time_point next_;
  std::uint64_t unlogged_ = 0;
};

}  // namespace sonopose::web::http
