#include "dds/binding/logged_errors.hpp"
#include "dds/binding/security.hpp"
#include <sonopose/dds/binding/error.hpp>
#include <sonopose/dds/binding/participant.hpp>

#include <utility>

namespace sonopose::dds {
namespace {

DomainOptions with_enclave(DomainOptions options) {
  if (options.enclave_folder.empty()) options.enclave_folder = enclave_by_environment();
  return options;
}

dds_entity_t create(std::uint32_t domain_id, const DomainOptions& options, const Qos& qos) {
  const std::string call = "dds_create_participant(domain " + std::to_string(domain_id);
  const std::string enclave = with_enclave(options).enclave_folder;
  if (enclave.empty()) {
    const std::string enable = "ROS_SECURITY_ENABLE";
    if (environment_variables({enable})[enable] == "true") {
      report_error(
          "security: ROS_SECURITY_KEYSTORE has no enclave for this process, so it joins without security, as "
          "ROS_SECURITY_STRATEGY=Permissive allows");
    }
    return check((call + ")").c_str(), dds_create_participant(domain_id, qos.get(), nullptr));
  }
  const auto uri = environment_variables({"CYCLONEDDS_URI"});
  if (!uri.empty() && network_named_by(uri.begin()->second, domain_id).shared_memory) {
    throw Error(call + ")", DDS_RETCODE_PRECONDITION_NOT_MET,
                "shared memory, which CYCLONEDDS_URI enables, bypasses DDS Security");
  }
  LoggedErrors logged;
  const dds_entity_t participant = dds_create_participant(domain_id, secured(qos, enclave).get(), nullptr);
  if (participant < 0) throw Error(call + ", enclave " + enclave + ")", participant, logged.text());
  if (!logged.text().empty()) report_error(logged.text());
  return participant;
}

}  // namespace

DomainParticipant::DomainParticipant(const DomainOptions& options, const Qos& qos)
    : DomainLease(with_enclave(options)),
      Entity(create(domain_id(), options, qos)),
      partition_(options.partition) {}

DomainParticipant& DomainParticipant::operator=(DomainParticipant&& other) noexcept {
  // Delete the old participant before releasing its reference to the domain.
  Entity::operator=(std::move(static_cast<Entity&>(other)));
  DomainLease::operator=(std::move(static_cast<DomainLease&>(other)));
  partition_ = std::move(other.partition_);
  return *this;
}

}  // namespace sonopose::dds
