#include "version.hpp"

namespace sonopose::apps {

std::string_view version() {
  return SONOPOSE_VERSION;
}

std::string_view version_text() {
  return SONOPOSE_VERSION " (sonopose::cxx: " SONOPOSE_CXX_BINDING ")";
}

}  // namespace sonopose::apps
