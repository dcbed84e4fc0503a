#include "version.hpp"

namespace sonopose::apps {

std::string_view version() {
  return SONOPOSE_VERSION;
}

}  // namespace sonopose::apps
