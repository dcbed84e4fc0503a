#include "toml/quoted.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

namespace sonopose::toml {

std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '\x7f', '?');  // allowed in JSON, not in TOML
  return nlohmann::json(std::move(text)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace sonopose::toml
