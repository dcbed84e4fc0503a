#include "security_commands.hpp"

#include "clocks/clocks.hpp"
#include "output.hpp"
#include "security/enclave.hpp"
#include "security/key_store.hpp"

#include <algorithm>
#include <stdexcept>

namespace sonopose::apps {
namespace {

std::int64_t time_now_s() {
  return clocks::host_now() / 1'000'000'000;
}

/// A day early, for machines whose clock is behind.
security::Validity validity(const SecurityOptions& options) {
  return {time_now_s() - security::day_s, time_now_s() + options.days * security::day_s};
}

}  // namespace

int make_store(const SecurityOptions& options) {
  const auto store = security::KeyStore::create(options.store, options.protection, time_now_s());
  print(
      "{} has two authorities. Keep {} where no robot is: who reads it can make enclaves.\n"
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
    store.add(name, {.roles = options.roles.empty() ? std::vector{name} : options.roles,
                     .partitions = options.partitions,
                     .validity = validity(options)});
    print("{}\n", store.enclave_folder(name).string());
  }
  return 0;
}

int list_enclaves(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  for (const std::string& name : store.enclaves()) {
    const auto enclave = security::read_enclave(store.enclave_folder(name), time_now_s());
    print("{}: until {}; {} ({})\n", name, security::date_text(enclave.expires_s),
          security::words_of(enclave.grant), enclave.protection);
  }
  return 0;
}

int check_store(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  const auto problems = security::check(store, time_now_s());
  for (const auto& problem : problems) print("{}: {}\n", problem.subject, problem.text);
  if (problems.empty()) print("{} enclaves, all in order\n", store.enclaves().size());
  return problems.empty() ? 0 : 1;
}

int renew_enclaves(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  for (const std::string& name : options.names.empty() ? store.enclaves() : options.names) {
    store.renew(name, validity(options));
    print("{}: until {}\n", name, security::date_text(validity(options).not_after_s));
  }
  print("Copy the enclaves to their machines, and restart their programs.\n");
  return 0;
}

int revoke_enclaves(const SecurityOptions& options) {
  const security::KeyStore store(options.store);
  for (const std::string& name : options.names) {
    print("{}: {} certificates revoked\n", name, store.revoke(name, time_now_s()));
  }
  print(
      "Copy public/crl.pem to every machine and restart its programs: DDS Security reads the list at the\n"
      "start only, and until then they still trust the enclave. Other DDS implementations may ignore it.\n");
  return 0;
}

int set_governance(const SecurityOptions& options) {
  security::KeyStore(options.store).set_protection(options.protection);
  print(
      "Copy governance.p7s to every enclave, and restart all programs at once: those with different "
      "protection refuse each other.\n");
  return 0;
}

}  // namespace sonopose::apps
