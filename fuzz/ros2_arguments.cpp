// Parses the arguments of a ROS 2 node, one per line, and a parameter file in YAML, after the line "== file".

#include "ros2/arguments/arguments.hpp"
#include "support.hpp"

#include <stdexcept>
#include <vector>

using namespace sonopose;
using namespace sonopose::fuzz;
namespace arguments = ros2::arguments;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const ScratchFolder folder;
  constexpr std::string_view title = "== file\n";
  const std::string_view input = text_of(data, size);
  const std::size_t found = input.find(title);
  if (found != std::string_view::npos) {
    const auto file = folder.write("parameters.yaml", input.substr(found + title.size()));
    accepts<arguments::ParameterFileError>([&] {
      for (const auto& parameter : arguments::read_parameter_file(file)) {
        promise(parameter.node.starts_with('/'), "a parameter belongs to a node");
        arguments::selects(parameter.node, "/robot/fusion");
      }
    });
  }
  std::vector<std::string> words;
  std::string_view rest = input.substr(0, found);
  constexpr std::size_t max_words = 64;
  while (!rest.empty() && words.size() < max_words) {
    const std::size_t end = rest.find('\n');
    words.emplace_back(rest.substr(0, end));
    // Any file could be named, even a device that never ends.
    if (words.back() == "--params-file") words.pop_back();
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  accepts<std::invalid_argument>([&] { arguments::split(words); });
  return 0;
}
