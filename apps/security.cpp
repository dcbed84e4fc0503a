// sonopose-security: makes and checks the key store of a secured bus.

#include "security/roles.hpp"
#include "support/choice.hpp"
#include "support/run.hpp"
#include "support/security_commands.hpp"

#include <string>
#include <vector>

using namespace sonopose;

int main(int argc, char** argv) {
  apps::SecurityOptions options;
  apps::Program app("security", "The key store has the layout of SROS2. SECURITY.md describes its use.");
  app.require_subcommand();
  const auto command = [&](const char* name, const char* description) {
    apps::CommandLine added = app.add_subcommand(name, description);
    added.add_option("STORE", options.store, "Folder of the key store").required().type_name("DIR");
    return added;
  };
  const auto protection = [&]<class Value>(apps::CommandLine to, Value& value) {
    return apps::add_choice<Value>(
        to, "--protect", value,
        {{"sign", security::Protection::sign}, {"encrypt", security::Protection::encrypt}},
        "sign: strangers cannot write; encrypt: nor read");
  };
  const auto days = [&](apps::CommandLine to, const char* otherwise) {
    to.add_option("--days", options.days,
                  std::string("Days until the certificates expire (default: ") + otherwise + ")")
        .check(apps::number_between(1, 3650));
  };
  apps::CommandLine making = command("init", "Make a key store");
  protection(making, options.protection);
  apps::CommandLine adding = command("enclave", "Make enclaves, each for one process or several of its kind");
  adding.add_option("NAME", options.names, "Names; that of a role needs no --role").required();
  adding.add_option("--role", options.roles, "What it may do; may be repeated")
      .check(apps::one_of(std::vector<std::string>(security::role_names.begin(), security::role_names.end())))
      .option_text("bridge|fusion|monitor|operator|ros2|recorder|web|autopilot|consumer")
      .allow_extra_args(false);
  adding
      .add_option("--partition", options.partitions,
                  "Partition it may use, or a pattern; may be repeated (default: no partition)")
      .allow_extra_args(false);
  adding.add_flag("--fastdds", options.for_fastdds,
                  "For a program with Fast DDS: its certificate lets the other side begin the handshake");
  days(adding, "365");
  apps::CommandLine listing = command("list", "Print what each enclave may do, and until when");
  apps::CommandLine checking =
      command("check", "Check dates, signatures and keys; exit code 1 for a problem");
  apps::CommandLine renewing = command("renew", "Make new keys and certificates, and sign permissions.xml");
  renewing.add_option("NAME", options.names, "Enclaves (default: all)");
  days(renewing, "as many as before");
  apps::CommandLine revoking = command("revoke", "Revoke every certificate of enclaves, and remove them");
  revoking.add_option("NAME", options.names, "Enclaves").required();
  apps::CommandLine governing = command("governance", "Sign governance.xml, or one with another protection");
  protection(governing, options.new_protection).option_text("sign|encrypt (default: as in governance.xml)");
  return apps::run(app, argc, argv, [&] {
    if (making.parsed()) return make_store(options);
    if (adding.parsed()) return add_enclaves(options);
    if (listing.parsed()) return list_enclaves(options);
    if (checking.parsed()) return check_store(options);
    if (renewing.parsed()) return renew_enclaves(options);
    return revoking.parsed() ? revoke_enclaves(options) : set_governance(options);
  });
}
