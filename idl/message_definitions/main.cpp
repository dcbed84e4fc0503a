// Prints the definitions of ROS 2's types in the form of .msg files, one C++ row {"wire name", "text"} per
// type, from the descriptions that type_hashes/main.cpp prints. The text has the type itself and then every
// type that it consists of, as the files of ROS 2's recorder have them.
//
//   message_definitions DESCRIPTIONS

#include <nlohmann/json.hpp>

#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

namespace {

using Json = nlohmann::json;

/// REP-2011: the type of a field is one of these, or an array of them by an offset.
const std::map<int, std::string> names{{2, "int8"},     {3, "uint8"},    {4, "int16"}, {5, "uint16"},
                                       {6, "int32"},    {7, "uint32"},   {8, "int64"}, {9, "uint64"},
                                       {10, "float32"}, {11, "float64"}, {13, "char"}, {15, "bool"},
                                       {16, "byte"},    {17, "string"}};
constexpr int nested_type = 1;
constexpr int bounded_string = 21;
constexpr int array_offset = 48;

/// "std_msgs/msg/Header" → "std_msgs/Header", as .msg files write it.
std::string short_name(std::string name) {
  const std::string middle = "/msg/";
  const auto at = name.find(middle);
  return at == std::string::npos ? name : name.replace(at, middle.size(), "/");
}

std::string element_of(int id, const Json& type) {
  if (id == nested_type) return short_name(type.at("nested_type_name"));
  if (id == bounded_string) return "string<=" + std::to_string(type.at("string_capacity").get<int>());
  const auto found = names.find(id);
  if (found == names.end()) throw std::runtime_error("no .msg type has the number " + std::to_string(id));
  return found->second;
}

std::string line_of(const Json& field) {
  const Json& type = field.at("type");
  const int id = type.at("type_id");
  const std::string capacity = std::to_string(type.at("capacity").get<int>());
  std::string text = element_of(id % array_offset, type);
  switch (id / array_offset) {
    case 0:
      break;
    case 1:
      text += "[" + capacity + "]";
      break;
    case 2:
      text += "[<=" + capacity + "]";
      break;
    default:
      text += "[]";
      break;
  }
  return text + " " + field.at("name").get<std::string>() + "\n";
}

std::string fields_of(const Json& description) {
  std::string text;
  for (const Json& field : description.at("fields")) text += line_of(field);
  return text;
}

std::string definition_of(const Json& description) {
  std::string text = fields_of(description.at("type_description"));
  for (const Json& used : description.at("referenced_type_descriptions")) {
    text += std::string(80, '=') + "\nMSG: " + short_name(used.at("type_name")) + "\n" + fields_of(used);
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw std::runtime_error("one file of descriptions is needed");
    std::ifstream lines(argv[1]);
    for (std::string line; std::getline(lines, line);) {
      const auto space = line.find(' ');
      if (line.find("::msg::") > space) continue;  // the requests and replies of services are not recorded
      const std::string text = definition_of(Json::parse(line.substr(space + 1)));
      std::printf("{\"%s\", R\"(%s)\"},\n", line.substr(0, space).c_str(), text.c_str());
    }
    return lines.bad() ? 1 : 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "message_definitions: %s\n", error.what());
    return 1;
  }
}
