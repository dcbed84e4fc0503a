#include "launch/execute.hpp"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <unistd.h>

namespace sonopose::launch {

void execute(const std::string& program, const std::vector<std::string>& arguments) {
  std::error_code no_proc;  // only PATH is searched without /proc
  const auto self = std::filesystem::read_symlink("/proc/self/exe", no_proc);
  const std::string beside = (self.parent_path() / program).string();

  std::vector<const char*> words{program.c_str()};
  for (const std::string& argument : arguments) words.push_back(argument.c_str());
  words.push_back(nullptr);
  auto* const argv = const_cast<char* const*>(words.data());  // execv(3) does not change them
  if (!no_proc) ::execv(beside.c_str(), argv);
  if (no_proc || errno == ENOENT) ::execvp(program.c_str(), argv);
}

}  // namespace sonopose::launch
