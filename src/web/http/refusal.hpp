#pragma once
/// \file
/// What a client and the log learn of a request that is refused.

#include "web/http/access.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace sonopose::web::http {

/// For the client; empty if it is allowed.
std::string reason_of(Verdict verdict);

/// The beginning of what a client sent, without what a terminal could take for a command.
std::string printable(std::string_view text);

/// Logs refused requests, one line in ten seconds at most.
class RefusalLog {
public:
  void add(Verdict verdict, const Credentials& credentials);
  void add(const std::string& line);

private:
  std::chrono::steady_clock::time_point next_;
  std::uint64_t unlogged_ = 0;
};

}  // namespace sonopose::web::http
