#include <sonopose/dds/binding/error.hpp>

namespace sonopose::dds {

Error::Error(const std::string& call, ReturnCode code)
    : std::runtime_error(call + ": " + dds_strretcode(-code)), code_(code) {}

}  // namespace sonopose::dds
