#include "dds/binding/announced_process.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <unistd.h>

namespace sonopose::dds {

void announce_process(dds_qos_t* qos) {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host = {};
  const auto value = [](std::string text) {
    std::ranges::replace(text, ';', '_');
    return text + ";";
  };
  void* earlier = nullptr;
  std::size_t size = 0;
  std::string text;
  if (dds_qget_userdata(qos, &earlier, &size) && earlier != nullptr) {
    text.assign(static_cast<const char*>(earlier), size);
    dds_free(earlier);
  }
  // A node of ROS 2 names its enclave, and its readers skip other keys. Other data are the application's.
  if (!text.empty() && !text.starts_with("enclave=")) return;
  text += "process=" + value(program_invocation_short_name);
  text += "pid=" + value(std::to_string(::getpid()));
  text += "host=" + value(host.data());
  dds_qset_userdata(qos, text.data(), text.size());
}

}  // namespace sonopose::dds
