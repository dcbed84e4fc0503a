// Counterpart of a two-process test. Writes reset commands with ascending ids to the domain of its arguments,
// on loopback or lan, until the standard input ends; then leaves in good order.
//
//   test_dds_peer DOMAIN loopback|lan ADDRESS
//
// With "poses" instead of the address it reads the fused poses.

#include <sonopose/dds/topics/topics.hpp>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <poll.h>
#include <string_view>
#include <unistd.h>

namespace {

/// Waits for 5 ms or the end of the standard input; returns true if it ended.
bool told_to_stop() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  return poll(&input, 1, 5) > 0;
}

void read_poses(const sonopose::dds::domain::DomainParticipant& participant) {
  using namespace sonopose::dds;
  sub::DataReader<sonopose_FusedPose> reader =
      topics::make_reader(participant, qos::Provider(), topics::pose);
  while (!told_to_stop()) ext::take_each(reader, [](const sonopose_FusedPose&, const sub::SampleInfo&) {});
}

}  // namespace

int main(int argc, char** argv) try {
  using namespace sonopose::dds;
  if (argc != 4) return 2;
  const bool lan = std::string_view(argv[2]) == "lan";
  const domain::DomainParticipant participant =
      ext::participant({.domain_id = static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10)),
                        .network = lan ? Network::lan : Network::loopback});
  if (std::string_view(argv[3]) == "poses") {
    read_poses(participant);
    return 0;
  }
  const topic::Topic<sonopose_ResetCommand> topic(participant, "test/peer");
  pub::DataWriter<sonopose_ResetCommand> writer(
      pub::Publisher(participant), topic,
      Qos() << policy::Reliability::Reliable() << policy::History::KeepLast(64));
  sonopose_ResetCommand command{};
  command.address = static_cast<std::uint16_t>(std::strtoul(argv[3], nullptr, 10));
  do {
    ++command.request_id;
    writer.write(command);
  } while (!told_to_stop());
  writer.unregister_instance(command);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
