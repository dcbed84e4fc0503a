// Prints a C++ header with a function for each struct of IDL files, which calls a visitor with the name and
// the value of each field, in the order of the IDL:
//
//   field_visitors FOLDER FILE.idl ...   # FOLDER of the headers that idlc makes, below <sonopose/idl>
//
// So nothing else needs a list of the fields.

#include "../type_hashes/idl_fields.h"
#include "../type_hashes/idl_text.hpp"

#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

/// The structs in the order of the IDL, each with the names of its fields.
using Structs = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// "sonopose::Vector3" → "sonopose_Vector3", as idlc calls it in C.
std::string c_name(std::string name) {
  const std::string scope = "::";
  for (std::size_t at = 0; (at = name.find(scope)) != std::string::npos;) name.replace(at, scope.size(), "_");
  return name;
}

void on_field(void* user, const idl_field* field) {
  auto& structs = *static_cast<Structs*>(user);
  const std::string owner = c_name(field->owner);
  if (structs.empty() || structs.back().first != owner) structs.push_back({owner, {}});
  structs.back().second.emplace_back(field->name);
}

void print(const std::filesystem::path& folder, const std::vector<std::string>& files,
           const Structs& structs) {
  std::puts("// Generated: visit_fields(sample, visitor) calls visitor(name, value) for each field.");
  std::puts("#pragma once\n");
  for (const std::string& file : files) {
    const auto header = folder / std::filesystem::path(file).stem();
    std::printf("#include <sonopose/idl/%s.h>\n", header.c_str());
  }
  std::puts("\nnamespace sonopose::idl {\n");
  for (const auto& [name, fields] : structs) {
    std::printf("template <class Visitor>\nvoid visit_fields(const %s& sample, Visitor&& visitor) {\n",
                name.c_str());
    for (const std::string& field : fields) {
      std::printf("  visitor(\"%s\", sample.%s);\n", field.c_str(), field.c_str());
    }
    std::puts("}\n");
  }
  std::puts("}  // namespace sonopose::idl");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) throw std::runtime_error("expected a folder and IDL files");
  const std::vector<std::string> files(argv + 2, argv + argc);
  Structs structs;
  if (idl_each_field(idl_text(files).c_str(), on_field, &structs) != 0) {
    throw std::runtime_error("the IDL is wrong");
  }
  if (structs.empty()) throw std::runtime_error("no struct in what is given");
  print(argv[1], files, structs);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "field_visitors: %s\n", error.what());
  return 1;
}
