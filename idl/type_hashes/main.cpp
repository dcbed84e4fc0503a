// Prints the descriptions of ROS 2's types (REP-2011) that the RIHS01 hashes are made of, from the given IDL
// files: one line per type, its name on the wire and its description in JSON, in the exact form in which
// rosidl writes it. hashes.cmake turns the lines into a table of hashes.
//
//   type_hashes FILE.idl ...
//
// Our IDL has the names of the wire, "pkg::msg::dds_::Name_"; the description has ROS's, "pkg/msg/Name".

#include "idl_fields.h"
#include "idl_text.hpp"

#include <cstdio>
#include <exception>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

namespace {

using Names = std::set<std::string>;

/// The description of one type: its fields in JSON, and the types they consist of.
struct Type {
  std::string wire_name;
  std::string fields;
  Names used;
};
using Types = std::map<std::string, Type>;  // by their names in ROS

/// The header of requests and replies, which is not a type of ROS 2.
const std::string middleware_header = "rmw_cyclonedds/srv/RequestHeader";

/// "sensor_msgs::msg::dds_::Imu_" → "sensor_msgs/msg/Imu".
std::string ros_name(const std::string& wire_name) {
  const std::string scope = "::dds_::";
  std::string name = wire_name;
  const std::size_t at = name.find(scope);
  if (at == std::string::npos || !name.ends_with('_')) {
    throw std::runtime_error(name + ": is not called as ROS 2 calls its types, pkg::msg::dds_::Name_");
  }
  name.pop_back();
  name.replace(at, scope.size(), "/");
  return name.replace(name.find("::"), 2, "/");
}

std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

void add_field(Types& types, const idl_field& field) {
  if (field.type_id == 0) {
    throw std::runtime_error(std::string(field.owner) + "." + field.name +
                             ": is of a type that is not known");
  }
  Type& owner = types[ros_name(field.owner)];
  owner.wire_name = field.owner;
  const std::string nested = *field.nested == '\0' ? "" : ros_name(field.nested);
  if (nested == middleware_header) return;
  if (!nested.empty()) owner.used.insert(nested);
  if (!owner.fields.empty()) owner.fields += ", ";
  owner.fields += R"({"name": )" + quoted(field.name) + R"(, "type": {"type_id": )" +
                  std::to_string(field.type_id) + R"(, "capacity": )" + std::to_string(field.capacity) +
                  R"(, "string_capacity": )" + std::to_string(field.string_capacity) +
                  R"(, "nested_type_name": )" + quoted(nested) + "}}";
}

std::string description(const std::string& name, const Types& types) {
  return R"({"type_name": )" + quoted(name) + R"(, "fields": [)" + types.at(name).fields + "]}";
}

/// Adds the types that a type uses, directly or through others.
void collect_used(const std::string& name, const Types& types, Names& used) {
  for (const std::string& other : types.at(name).used) {
    if (used.insert(other).second) collect_used(other, types, used);
  }
}

std::string whole_description(const std::string& name, const Types& types) {
  Names used;
  collect_used(name, types, used);
  std::string referenced;
  for (const std::string& other : used) {
    referenced += (referenced.empty() ? "" : ", ") + description(other, types);
  }
  return R"({"type_description": )" + description(name, types) + R"(, "referenced_type_descriptions": [)" +
         referenced + "]}";
}

struct Reading {
  Types types;
  std::exception_ptr error;  ///< must not pass through the parser
};

void on_field(void* user, const idl_field* field) {
  auto& reading = *static_cast<Reading*>(user);
  try {
    if (!reading.error) add_field(reading.types, *field);
  } catch (...) {
    reading.error = std::current_exception();
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string text = idl_text({argv + 1, argv + argc});
  Reading reading;
  if (idl_each_field(text.c_str(), on_field, &reading) != 0) throw std::runtime_error("the IDL is wrong");
  if (reading.error) std::rethrow_exception(reading.error);
  if (reading.types.empty()) throw std::runtime_error("no type in what is given");
  for (const auto& [name, type] : reading.types) {
    std::printf("%s %s\n", type.wire_name.c_str(), whole_description(name, reading.types).c_str());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "type_hashes: %s\n", error.what());
  return 1;
}
