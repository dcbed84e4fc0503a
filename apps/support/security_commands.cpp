#include "security_commands.hpp"

#include "host_seconds.hpp"
#include "logging/log.hpp"
#include "output.hpp"
#include "security/enclave.hpp"
#include "security/error.hpp"
#include "security/key_store.hpp"

#include <algorithm>
#include <stdexcept>

namespace sonopose::apps {
namespace {

constexpr int default_days = 365;

/// A day early, for machines whose clock is behind.
security::Validity validity(std::int64_t days) {
  return {host_now_s() - security::day_s, host_now_s() + days * security::day_s};
}

/// Returns for how long an enclave was made; the default if its certificate is unreadable.
int earlier_days(const std::filesystem::path& enclave) {
  try {
    const std::filesystem::path file = enclave / security::certificate_file;
    const auto earlier = security::facts_of(security::read_file(file, ""), file.string()).validity;
    const std::int64_t days = (earlier.not_after_s - earlier.not_before_s) / security::day_s - 1;
    return static_cast<int>(std::clamp<std::int64_t>(days, 1, 3650));
  } catch (const security::SecurityError&) {
    return default_days;
  }
}

}  // namespace

int make_store(const SecurityOptions& options) {
  const auto store = security::KeyStore::create(options.store, options.protection, host_now_s());
  print(
      "{} has two authorities. Do not copy {} to robots: its readers can make enclaves.\n"
      "Next: sonopose-security enclave {} bridge fusion monitor\n",
      store.folder().string(), (store.folder() / "private").string(), store.folder().string());
  return 0;
}

int add_enclaves(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  for (const std::string& name : options.names) {
    const auto is_role = [&](const char* role) { return name == role; };
    if (options.roles.empty() && std::ranges::none_of(security::role_names, is_role)) {
      throw std::invalid_argument(name + ": not the name of a role, so it needs --role");
    }
    static_cast<void>(store.enclave_folder(name));  // throws for a wrong name, before the first is made
  }
  for (const std::string& name : options.names) {
    store.add(name, {.roles = options.roles.empty() ? std::vector{name} : options.roles,
                     .partitions = options.partitions,
                     .validity = validity(options.days.value_or(default_days)),
                     .handshake =
                         options.for_fastdds ? security::Handshake::answers : security::Handshake::either});
    print("{}\n", store.enclave_folder(name).string());
  }
  return 0;
}

int list_enclaves(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  int code = 0;
  for (const std::string& name : store.enclaves()) {
    try {
      const auto enclave = security::read_enclave(store.enclave_folder(name), host_now_s());
      const bool is_own = security::is_subject_of(name, enclave.subject);
      print("{}: until {}; {}{} ({})\n", name, security::date_text(enclave.expires_s),
            is_own ? "" : "the files of " + enclave.subject + ": ", security::words_of(enclave.grant),
            enclave.protection);
    } catch (const security::SecurityError& error) {
      print("{}: unusable: {}\n", name, error.what());
      code = 1;
    }
  }
  return code;
}

int check_store(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  const auto problems = security::check(store, host_now_s());
  for (const auto& problem : problems) print("{}: {}\n", problem.subject, problem.text);
  if (problems.empty()) print("{} enclaves, all in order\n", store.enclaves().size());
  return problems.empty() ? 0 : 1;
}

int renew_enclaves(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  int code = 0;
  for (const std::string& name : options.names.empty() ? store.enclaves() : options.names) {
    try {
      const std::int64_t days = options.days.value_or(earlier_days(store.enclave_folder(name)));
      store.renew(name, validity(days));
      security::read_enclave(store.enclave_folder(name), host_now_s());  // throws for what this did not mend
      print("{}: until {}\n", name, security::date_text(validity(days).not_after_s));
    } catch (const security::SecurityError& error) {
      logging::failure(fmt::format("{}: {}", name, error.what()));
      code = 1;
    }
  }
  print("Copy the enclaves to their machines, and restart their programs.\n");
  return code;
}

int revoke_enclaves(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  for (const std::string& name : options.names) {
    print("{}: {} certificates revoked\n", name, store.revoke(name, host_now_s()));
  }
  print(
      "Copy public/crl.pem to every machine and restart its programs: DDS Security reads the list at the\n"
      "start only, and until then they still trust the enclave. Other DDS implementations may ignore it.\n");
  return 0;
}

int set_governance(const SecurityOptions& options) {
  const std::string change = security::KeyStore(options.store).set_protection(options.new_protection);
  print("protection: {}\n", change);
  print(
      "Copy governance.p7s to every enclave, and restart all programs at once: those with different "
      "protection refuse each other.\n");
  return 0;
}

}  // namespace sonopose::apps
