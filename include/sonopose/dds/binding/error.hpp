#pragma once
/// \file
/// Errors of the DDS layer: every negative return of Cyclone DDS becomes an `Error` that names the call.

#include <dds/dds.h>

#include <stdexcept>
#include <string>

namespace sonopose::dds {

/// Result of a Cyclone DDS call: negative is an error (`DDS_RETCODE_…`), anything else a success.
using ReturnCode = dds_return_t;

/// A DDS call that failed. `what()` names the call, its object, and Cyclone's text for the reason.
class Error : public std::runtime_error {
public:
  Error(const std::string& call, ReturnCode code);
  /// The same with another text for the reason.
  Error(const std::string& call, ReturnCode code, const std::string& reason);

  /// `DDS_RETCODE_…`; negative.
  ReturnCode code() const noexcept { return code_; }

  /// True if too few file descriptors or threads, or too little memory, were free.
  bool is_out_of_resources() const noexcept { return code_ == DDS_RETCODE_OUT_OF_RESOURCES; }

private:
  ReturnCode code_;
};

/// True if a `try_…` call timed out.
inline bool is_timeout(ReturnCode code) noexcept {
  return code == DDS_RETCODE_TIMEOUT;
}

/// Repeats `attempt()`, a `try_…` call, after timeouts until `give_up()` returns true. Returns the last code.
ReturnCode retry_unless(const auto& give_up, const auto& attempt) {
  ReturnCode code = attempt();
  while (is_timeout(code) && !give_up()) code = attempt();
  return code;
}

/// Returns a good code; throws `Error` for a negative one.
inline ReturnCode check(const char* call, ReturnCode code) {
  if (code < 0) throw Error(call, code);
  return code;
}

/// Like `check(call, code)`; the error also names the object of the call, such as the topic.
inline ReturnCode check(const char* call, const std::string& about, ReturnCode code) {
  if (code < 0) throw Error(std::string(call) + "(" + about + ")", code);
  return code;
}

}  // namespace sonopose::dds
