#include "choice.hpp"

namespace sonopose::apps {

CLI::Validator one_of(const std::vector<std::string>& words) {
  return {[words](const std::string& text) {
            const bool known = std::find(words.begin(), words.end(), text) != words.end();
            return known ? std::string() : "'" + text + "' is not one of " + CLI::detail::join(words, ", ");
          },
          "{" + CLI::detail::join(words, ",") + "}"};
}

}  // namespace sonopose::apps
