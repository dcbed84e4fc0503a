// Reads a user's QoS file: complete, and merged over the project's.

#include "support.hpp"
#include <sonopose/dds/qos/match.hpp>
#include <sonopose/dds/qos/provider.hpp>

using namespace sonopose;
using namespace sonopose::fuzz;
using sonopose::dds::qos::FileError;
using sonopose::dds::qos::Provider;

namespace {

/// Checks that each profile can be read, and that those of the project still match themselves.
void check_profiles(const Provider& provider) {
  for (const std::string& profile : provider.profiles()) {
    provider.topic_qos(profile);
    provider.participant_qos(profile);
    if (profile.starts_with("sonopose::")) {
      promise(
          sonopose::dds::qos::mismatches(provider.datawriter_qos(profile), provider.datareader_qos(profile))
              .empty(),
          "the reader of a profile matches its writer");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Provider project;
  const std::string text(text_of(data, size));
  accepts<FileError>([&] {
    const Provider alone = Provider::from_string(text, "input");
    promise(alone.profiles().size() <= text.size(), "each profile is in the file");
    for (const std::string& profile : alone.profiles()) alone.datawriter_qos(profile);
  });
  Provider merged = project;
  const bool is_accepted = accepts<FileError>([&] { merged.merge(text, "input"); });
  promise(merged.profiles() == project.profiles(), "a user's file adds and removes no profile");
  check_profiles(merged);
  if (is_accepted) {
    static const ScratchFolder folder;
    const Provider from_file(folder.write("qos.xml", text));
    promise(from_file.profiles() == merged.profiles(), "a file is read as its text");
    check_profiles(from_file);
  }
  return 0;
}
