#include "dds/binding/error.hpp"

namespace sonopose::dds {

namespace {

std::string reason_of(dds_return_t code) {
  const std::string text = dds_strretcode(-code);
  if (code != DDS_RETCODE_NOT_ALLOWED_BY_SECURITY) return text;
  return text +
         ": the permissions of the enclave do not include it, or not in this partition (sonopose-security "
         "list)";
}

}  // namespace

Error::Error(const std::string& call, dds_return_t code) : Error(call, code, reason_of(code)) {}

Error::Error(const std::string& call, dds_return_t code, const std::string& reason)
    : std::runtime_error(call + ": " + reason), code_(code) {}

}  // namespace sonopose::dds
