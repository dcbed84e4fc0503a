#include "transport/byte_source.hpp"

namespace sonopose::transport {

HostTime host_now() {
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count();
}

}  // namespace sonopose::transport
