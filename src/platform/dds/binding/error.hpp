#pragma once
/// \file
/// Errors of this module. They reach others as the exceptions of the PSM.

#include <dds/dds.h>

#include <stdexcept>
#include <string>

namespace sonopose::dds {

/// A call of Cyclone DDS that failed. `what()` names the call, its object, and Cyclone's text for the reason.
class Error : public std::runtime_error {
public:
  Error(const std::string& call, dds_return_t code);
  /// Gives another text than Cyclone's for the reason.
  Error(const std::string& call, dds_return_t code, const std::string& reason);

  /// `DDS_RETCODE_…`; negative.
  dds_return_t code() const noexcept { return code_; }

private:
  dds_return_t code_;
};

/// Returns a good code; throws `Error` for a negative one.
inline dds_return_t check(const char* call, dds_return_t code) {
  if (code < 0) throw Error(call, code);
  return code;
}

/// Like `check(call, code)`; the error also names the object of the call, such as the topic.
inline dds_return_t check(const char* call, const std::string& about, dds_return_t code) {
  if (code < 0) throw Error(std::string(call) + "(" + about + ")", code);
  return code;
}

}  // namespace sonopose::dds
