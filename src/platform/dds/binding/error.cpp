#include <sonopose/dds/binding/error.hpp>

namespace sonopose::dds {

Error::Error(const std::string& call, ReturnCode code) : Error(call, code, dds_strretcode(-code)) {}

Error::Error(const std::string& call, ReturnCode code, const std::string& reason)
    : std::runtime_error(call + ": " + reason), code_(code) {}

}  // namespace sonopose::dds
