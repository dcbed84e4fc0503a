#include "dds/binding/participant.hpp"

#include "dds/binding/announced_process.hpp"
#include "dds/binding/error.hpp"
#include "dds/binding/logged_errors.hpp"
#include "dds/binding/security.hpp"

namespace sonopose::dds {
namespace {

DomainOptions with_enclave(DomainOptions options) {
  if (options.enclave_folder.empty()) options.enclave_folder = enclave_by_environment();
  return options;
}

dds_entity_t create(std::uint32_t domain_id, const DomainOptions& options, dds_qos_t* qos) {
  const std::string call = "dds_create_participant(domain " + std::to_string(domain_id);
  const std::string enclave = with_enclave(options).enclave_folder;
  if (enclave.empty()) {
    const std::string enable = "ROS_SECURITY_ENABLE";
    if (is_true(enable, environment_variables({enable})[enable])) {
      report_error(
          "security: ROS_SECURITY_KEYSTORE has no enclave for this process, so it joins without security, as "
          "ROS_SECURITY_STRATEGY=Permissive allows");
    }
    return check((call + ")").c_str(), dds_create_participant(domain_id, qos, nullptr));
  }
  const auto uri = environment_variables({"CYCLONEDDS_URI"});
  if (!uri.empty() && network_named_by(uri.begin()->second, domain_id).shared_memory) {
    throw Error(call + ")", DDS_RETCODE_PRECONDITION_NOT_MET,
                "shared memory, which CYCLONEDDS_URI enables, bypasses DDS Security");
  }
  LoggedErrors logged;
  secure(qos, enclave);
  announce_process(qos);
  const dds_entity_t participant = dds_create_participant(domain_id, qos, nullptr);
  if (participant < 0) throw Error(call + ", enclave " + enclave + ")", participant, logged.text());
  if (!logged.text().empty()) report_error(logged.text());
  return participant;
}

}  // namespace

Membership::Membership(const DomainOptions& options, dds_qos_t* qos)
    : lease_(with_enclave(options)), handle_(create(lease_.domain_id(), options, qos)) {}

Membership::~Membership() {
  dds_delete(handle_);
}

}  // namespace sonopose::dds
