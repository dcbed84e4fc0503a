/* A consumer in plain C: prints where every beacon on the bus is. The argument is the number of poses to print; default
   unlimited. The domain is ROS_DOMAIN_ID, otherwise 0, as for the programs. The network is that of CYCLONEDDS_URI, which
   must name the loopback configuration (README, "Add a consumer"): without it, no program of a default setup is found. */

#include "sonopose.h"

#include <dds/dds.h>

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

enum { max_samples = 32 };

static dds_entity_t require(dds_entity_t result, const char* call) {
  if (result < 0) {
    fprintf(stderr, "%s: %s\n", call, dds_strretcode(result));
    exit(1);
  }
  return result;
}

static dds_domainid_t domain_id(void) {
  const char* text = getenv("ROS_DOMAIN_ID");
  return text != NULL && *text != '\0' ? (dds_domainid_t)strtoul(text, NULL, 10) : 0;
}

/* Exclusive, as the writers of poses are: a second fusion may stand by for the first one. */
static dds_entity_t pose_reader(dds_entity_t participant) {
  const dds_entity_t topic = require(
      dds_create_topic(participant, &sonopose_FusedPose_desc, "sonopose/pose", NULL, NULL), "dds_create_topic");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, max_samples);
  dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
  const dds_entity_t reader = require(dds_create_reader(participant, topic, qos, NULL), "dds_create_reader");
  dds_delete_qos(qos);
  return reader;
}

static bool has_writer(dds_entity_t reader) {
  dds_subscription_matched_status_t matched;
  require(dds_get_subscription_matched_status(reader, &matched), "dds_get_subscription_matched_status");
  return matched.current_count > 0;
}

static long print_poses(dds_entity_t reader) {
  void* samples[max_samples] = {NULL};
  dds_sample_info_t infos[max_samples];
  const int32_t taken = require(dds_take(reader, samples, infos, max_samples, max_samples), "dds_take");
  long printed = 0;
  for (int32_t i = 0; i < taken; ++i) {
    if (!infos[i].valid_data) continue;
    const sonopose_FusedPose* pose = samples[i];
    printf("%" PRIu16 ": %.3f %.3f %.3f\n", pose->address, pose->position.x, pose->position.y, pose->position.z);
    ++printed;
  }
  if (taken > 0) require(dds_return_loan(reader, samples, taken), "dds_return_loan");
  return printed;
}

int main(int argc, char** argv) {
  const long max_poses = argc > 1 ? strtol(argv[1], NULL, 10) : 0;
  const dds_domainid_t domain = domain_id();
  const dds_entity_t participant = require(dds_create_participant(domain, NULL, NULL), "dds_create_participant");
  const dds_entity_t reader = pose_reader(participant);
  const dds_entity_t has_data = require(dds_create_readcondition(reader, DDS_ANY_STATE), "dds_create_readcondition");
  const dds_entity_t waitset = require(dds_create_waitset(participant), "dds_create_waitset");
  require(dds_waitset_attach(waitset, has_data, 0), "dds_waitset_attach");

  for (long printed = 0; max_poses == 0 || printed < max_poses;) {
    const dds_return_t ready = require(dds_waitset_wait(waitset, NULL, 0, DDS_SECS(5)), "dds_waitset_wait");
    if (ready == 0 && !has_writer(reader)) {
      fprintf(stderr, "no sonopose-fusion is found in domain %" PRIu32 "; is CYCLONEDDS_URI set as the README says?\n",
              domain);
    }
    printed += print_poses(reader);
    fflush(stdout);
  }
  require(dds_delete(participant), "dds_delete");
  return 0;
}
