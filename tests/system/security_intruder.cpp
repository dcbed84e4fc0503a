// A process that joins a secured bus with the files of a folder, which it does not check as our programs do:
// security_intruder DOMAIN FOLDER writes poses as the strongest of all, or reads them if a third argument
// says when its certificate expires, in seconds since 1970.

#include <sonopose/dds/topics/topics.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <thread>

namespace {

using namespace sonopose;
namespace dds = sonopose::dds;

void print(const char* text) {
  std::puts(text);
  std::fflush(stdout);
}

void pause() {
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

[[noreturn]] void write_poses(const dds::domain::DomainParticipant& participant) {
  auto writer = dds::topics::make_writer(participant, dds::qos::Provider(), dds::topics::pose);
  writer.qos(writer.qos() << dds::policy::OwnershipStrength(1'000'000));
  sonopose_FusedPose pose{};
  pose.address = 7;
  print("writing");
  for (;; pause()) {
    pose.time = pose.fusion_out_time =
        std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
    ++pose.event_sequence;
    dds::ext::try_write(writer, pose);
  }
}

/// Cyclone DDS gives no status when the own certificate expires: only the poses end.
[[noreturn]] void read_poses(const dds::domain::DomainParticipant& participant, std::time_t expires_s) {
  auto reader = dds::topics::make_reader(participant, dds::qos::Provider(), dds::topics::pose);
  const auto has_poses = [&reader] {
    std::size_t count = 0;
    dds::ext::take_each(reader,
                        [&count](const sonopose_FusedPose&, const dds::sub::SampleInfo&) { ++count; });
    return count > 0;
  };
  const auto now = [] { return std::chrono::steady_clock::now(); };
  while (!has_poses()) pause();
  print("receives poses");
  for (auto last = now(); now() - last < std::chrono::seconds(2); pause()) {
    if (has_poses() || std::time(nullptr) <= expires_s) last = now();
  }
  print("receives no poses");
  for (;;) pause();
}

}  // namespace

int main(int argc, char** argv) try {
  namespace dds = sonopose::dds;
  if (argc < 3) return 2;
  const auto participant =
      dds::ext::participant({.domain_id = static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10)),
                             .enclave_folder = argv[2]});
  if (argc > 3) read_poses(participant, std::strtoll(argv[3], nullptr, 10));
  write_poses(participant);
} catch (const std::exception& error) {
  std::printf("refused: %s\n", error.what());
  return 1;
}
