#include <sonopose/text/count_text.hpp>

namespace sonopose::text {

std::string count_text(std::uint64_t count, std::string_view noun, std::string_view plural) {
  std::string text = std::to_string(count) + ' ';
  if (count != 1 && !plural.empty()) return text.append(plural);
  text.append(noun);
  return count == 1 ? text : text + 's';
}

std::string first_of(std::string first, std::size_t count) {
  if (count > 1) first.append(" and ").append(std::to_string(count - 1)).append(" more");
  return first;
}

}  // namespace sonopose::text
