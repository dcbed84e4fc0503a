#include "dds/binding/security.hpp"

#include "dds/binding/logged_errors.hpp"
#include <sonopose/dds/binding/domain.hpp>

#include <dds/ddsrt/time.h>
#include <dds/version.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <dlfcn.h>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace {

std::atomic<std::uint64_t> unlimited_handshakes_count = 0;

}  // namespace

#if DDS_VERSION_MAJOR == 0  // 11.0 is the first release without the defect
/// Replaces the function of Cyclone DDS that limits a handshake to 100 s. The linker finds this one first.
/// The original removes its timer from the heap of timers a second time: the next handshake, of whomever,
/// works on freed memory (https://github.com/eclipse-cyclonedds/cyclonedds/issues/1548). So any stranger who
/// starts a handshake and waits could end all secured processes. Without the limit, a handshake is tried each
/// second until it succeeds or the peer leaves.
extern "C" {
struct dds_security_fsm;  // its header is not C++
[[gnu::visibility("default")]] void dds_security_fsm_set_timeout(dds_security_fsm* /*handshake*/,
                                                                 void (* /*action*/)(dds_security_fsm*,
                                                                                     void*),
                                                                 dds_duration_t /*limit*/) {
  ++unlimited_handshakes_count;
}
}
#endif

namespace sonopose::dds {
namespace {

/// Warns once if Cyclone DDS finds its own function first, as in a program that is linked with it before
/// this.
void check_handshake_limit() {
#if DDS_VERSION_MAJOR == 0
  // The address of our function would also be that of the first one: compare where they are.
  Dl_info first{};
  Dl_info ours{};
  const void* const found = ::dlsym(RTLD_DEFAULT, "dds_security_fsm_set_timeout");
  if (found != nullptr && ::dladdr(found, &first) != 0 &&
      ::dladdr(static_cast<const void*>(&unlimited_handshakes_count), &ours) != 0 &&
      first.dli_fbase == ours.dli_fbase) {
    return;
  }
  static std::once_flag once;
  std::call_once(once, [] {
    report_error(
        "security: a stranger's handshake of 100 s can end this process, since the linker finds Cyclone DDS "
        "before sonopose: link sonopose first (SECURITY.md)");
  });
#endif
}

}  // namespace

std::uint64_t unlimited_handshakes() {
  return unlimited_handshakes_count;
}

void secure(dds_qos_t* qos, const std::string& enclave_folder) {
  check_handshake_limit();
  using Pair = std::pair<const char*, const char*>;
  constexpr std::array plugins{
      Pair{"dds.sec.auth.library.path", "dds_security_auth"},
      Pair{"dds.sec.auth.library.init", "init_authentication"},
      Pair{"dds.sec.auth.library.finalize", "finalize_authentication"},
      Pair{"dds.sec.crypto.library.path", "dds_security_crypto"},
      Pair{"dds.sec.crypto.library.init", "init_crypto"},
      Pair{"dds.sec.crypto.library.finalize", "finalize_crypto"},
      Pair{"dds.sec.access.library.path", "dds_security_ac"},
      Pair{"dds.sec.access.library.init", "init_access_control"},
      Pair{"dds.sec.access.library.finalize", "finalize_access_control"},
  };
  constexpr std::array files{
      Pair{"dds.sec.auth.identity_ca", "identity_ca.cert.pem"},
      Pair{"dds.sec.auth.identity_certificate", "cert.pem"},
      Pair{"dds.sec.auth.private_key", "key.pem"},
      Pair{"dds.sec.access.permissions_ca", "permissions_ca.cert.pem"},
      Pair{"dds.sec.access.governance", "governance.p7s"},
      Pair{"dds.sec.access.permissions", "permissions.p7s"},
      Pair{"org.eclipse.cyclonedds.sec.auth.crl", "crl.pem"},
  };
  for (const auto& [name, value] : plugins) dds_qset_prop(qos, name, value);
  const std::filesystem::path folder = enclave_folder;
  for (const auto& [name, file] : files) {
    std::error_code absent;
    const std::filesystem::path path = folder / file;
    const bool is_optional = std::string_view(file) == "crl.pem";
    // A link that leads nowhere is a list that was lost, which Cyclone DDS refuses.
    const auto status = std::filesystem::symlink_status(path, absent);
    if (is_optional && !std::filesystem::exists(status)) continue;
    dds_qset_prop(qos, name, ("file:" + path.string()).c_str());
  }
}

bool is_true(const std::string& name, const std::string& value) {
  std::string word = value;
  std::ranges::transform(word, word.begin(), [](unsigned char each) { return std::tolower(each); });
  if (word == "true") return true;
  if (word.empty() || word == "false") return false;
  // ROS 2 takes all but "true" for false, and so joins without security, silently.
  throw std::invalid_argument(name + " is '" + value + "': must be true or false");
}

std::string enclave_by_environment(const std::string& name) {
  const std::string enable = "ROS_SECURITY_ENABLE";
  const std::string key_store = "ROS_SECURITY_KEYSTORE";
  const std::string strategy = "ROS_SECURITY_STRATEGY";
  const std::string override = "ROS_SECURITY_ENCLAVE_OVERRIDE";
  auto variables = environment_variables({enable, key_store, strategy, override});
  if (!is_true(enable, variables[enable])) return {};
  if (variables[key_store].empty()) {
    throw std::invalid_argument(enable + " is true, but " + key_store + " names no key store");
  }
  std::string enclave = !name.empty()                  ? name
                        : !variables[override].empty() ? variables[override]
                                                       : "consumer";
  enclave.erase(0, enclave.find_first_not_of('/'));
  const std::filesystem::path folder = std::filesystem::path(variables[key_store]) / "enclaves" / enclave;
  std::error_code error;
  // In ROS 2, all but Enforce join without security. A mistyped name must not; so this takes the word for it.
  const bool may_be_absent = variables[strategy] == "Permissive";
  if (may_be_absent && !std::filesystem::is_directory(folder, error)) return {};
  return folder.string();
}

}  // namespace sonopose::dds
