// A process that joins a domain as rmw_cyclonedds does, with this configuration only. It waits for a sample
// on "test/to_peer", then writes one with its number on "test/from_peer", until it is killed.
//
//   test_ros2_peer DOMAIN CONFIGURATION NUMBER

#include <sonopose/idl/sonopose.h>

#include <dds/dds.h>

#include <stdio.h>
#include <stdlib.h>

static dds_entity_t checked(const char* call, dds_entity_t result) {
  if (result < 0) {
    fprintf(stderr, "%s: %s\n", call, dds_strretcode(-result));
    exit(1);
  }
  return result;
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const dds_domainid_t domain = (dds_domainid_t)strtoul(argv[1], NULL, 10);
  checked("dds_create_domain", dds_create_domain(domain, argv[2]));
  const dds_entity_t participant =
      checked("dds_create_participant", dds_create_participant(domain, NULL, NULL));
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  const dds_topic_descriptor_t* type = &sonopose_ResetCommand_desc;
  const dds_entity_t in = dds_create_topic(participant, type, "test/to_peer", NULL, NULL);
  const dds_entity_t out = dds_create_topic(participant, type, "test/from_peer", NULL, NULL);
  const dds_entity_t reader = checked("dds_create_reader", dds_create_reader(participant, in, qos, NULL));
  const dds_entity_t writer = checked("dds_create_writer", dds_create_writer(participant, out, qos, NULL));
  dds_delete_qos(qos);

  const dds_entity_t waitset = dds_create_waitset(participant);
  const dds_entity_t news = dds_create_readcondition(reader, DDS_ANY_STATE);
  checked("dds_waitset_attach", dds_waitset_attach(waitset, news, 0));
  dds_attach_t triggered = 0;
  checked("dds_waitset_wait", dds_waitset_wait(waitset, &triggered, 1, DDS_INFINITY));
  sonopose_ResetCommand received = {.address = (uint16_t)strtoul(argv[3], NULL, 10)};
  checked("dds_write", dds_write(writer, &received));
  for (;;) dds_sleepfor(DDS_SECS(1));
}
