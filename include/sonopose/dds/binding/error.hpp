#pragma once
/// \file
/// Errors of domains. They reach others as the exceptions of the PSM.

#include <dds/dds.h>

#include <stdexcept>
#include <string>

namespace sonopose::dds {

/// Result of a Cyclone DDS call: negative is an error (`DDS_RETCODE_…`), anything else a success.
using ReturnCode = dds_return_t;

/// A call of Cyclone DDS that failed. `what()` names the call, its object, and Cyclone's text for the reason.
class Error : public std::runtime_error {
public:
  Error(const std::string& call, ReturnCode code);
  /// The same with another text for the reason.
  Error(const std::string& call, ReturnCode code, const std::string& reason);

  /// `DDS_RETCODE_…`; negative.
  ReturnCode code() const noexcept { return code_; }

private:
  ReturnCode code_;
};

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
