#pragma once
// The options of DDS Security, common to all programs on the bus (SECURITY.md).

#include "bus_options.hpp"
#include "command_line.hpp"

namespace sonopose::apps {

/// Adds --security and --enclave. `options` must outlive the parsing.
void add_security_options(CommandLine& app, BusOptions& options);

/// Selects the enclave and checks its files, after the parsing. Throws config::ConfigError, which names the
/// option or variable, the file that cannot be used, and the verb that mends it.
void check_security(const CommandLine& app, BusOptions& options);

/// Returns the name of the enclave for ROS 2: that in use, without security the given one, "/" if there is
/// none.
std::string announced_enclave(const BusOptions& options);

/// Logs which enclave is in use. Warns each day of an expiry within 30 days, and ends the program in good
/// order with the code of a wrong configuration when it comes: Cyclone DDS then removes the participant.
void watch_expiry(const dds::DomainOptions& domain);

}  // namespace sonopose::apps
