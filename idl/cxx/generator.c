// A generator of idlc (`idlc -l libsonopose_idlcxx.so file.idl`): prints file.hpp with the classes of an IDL
// file, as cyclonedds-cxx's generator makes them, and their conversions from and to idlc's structs in C, for
// <dds/dds.hpp> of sonopose. In C, since the headers of idlc's parser are no C++.

#include <ctype.h>
#include <idl/processor.h>
#include <idl/string.h>
#include <idl/tree.h>
#include <idlc/generator.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct output {
  FILE* file;
  const idl_pstate_t* state;
  const void* refused[64];  // nodes
  bool failed;
};

static void print(struct output* out, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  if (vfprintf(out->file, format, arguments) < 0) out->failed = true;
  va_end(arguments);
}

static void refuse(struct output* out, const void* node, const char* what) {
  out->failed = true;
  size_t count = 0;  // a field's type is printed several times
  for (; count < sizeof(out->refused) / sizeof(out->refused[0]) && out->refused[count] != NULL; ++count) {
    if (out->refused[count] == node) return;
  }
  if (count < sizeof(out->refused) / sizeof(out->refused[0])) out->refused[count] = node;
  const idl_position_t* at = &idl_location(node)->first;
  fprintf(stderr, "%s:%" PRIu32 ":%" PRIu32 ": %s are not supported by sonopose's C++ generator\n",
          at->source->path->name, at->line, at->column, what);
}

// Returns the name of a definition. Refuses the reserved words of C++, which the struct in C cannot have
// either.
static const char* name_of(struct output* out, const void* node) {
  static const char* const reserved[] = {
      "alignas",     "alignof",  "and",        "and_eq",    "asm",       "auto",         "bitand",
      "bitor",       "bool",     "break",      "case",      "catch",     "char",         "char16_t",
      "char32_t",    "char8_t",  "class",      "co_await",  "co_return", "co_yield",     "compl",
      "concept",     "const",    "const_cast", "consteval", "constexpr", "constinit",    "continue",
      "decltype",    "default",  "delete",     "do",        "double",    "dynamic_cast", "else",
      "enum",        "explicit", "export",     "extern",    "false",     "float",        "for",
      "friend",      "goto",     "if",         "inline",    "int",       "long",         "mutable",
      "namespace",   "new",      "noexcept",   "not",       "not_eq",    "nullptr",      "operator",
      "or",          "or_eq",    "private",    "protected", "public",    "register",     "reinterpret_cast",
      "requires",    "return",   "short",      "signed",    "sizeof",    "static",       "static_assert",
      "static_cast", "struct",   "switch",     "template",  "this",      "thread_local", "throw",
      "true",        "try",      "typedef",    "typeid",    "typename",  "union",        "unsigned",
      "using",       "virtual",  "void",       "volatile",  "wchar_t",   "while",        "xor",
      "xor_eq"};
  const char* name = idl_identifier(node);
  for (size_t i = 0; i < sizeof(reserved) / sizeof(reserved[0]); ++i) {
    if (strcmp(name, reserved[i]) == 0) refuse(out, node, "reserved words of C++ as names");
  }
  return name;
}

// Prints the scopes and the name of a definition: "::a::b::Name", or "a_b_Name" as in C.
static void print_scoped(struct output* out, const void* node, bool in_c) {
  const void* scope = idl_parent(node);
  while (scope != NULL && !idl_is_module(scope)) scope = idl_parent(scope);
  if (scope != NULL) {
    print_scoped(out, scope, in_c);
    if (in_c) print(out, "_");
  }
  print(out, in_c ? "%s" : "::%s", idl_identifier(node));
}

static const char* base_type(idl_type_t type) {
  switch (type) {
    case IDL_CHAR:
      return "char";
    case IDL_BOOL:
      return "bool";
    case IDL_INT8:
      return "int8_t";
    case IDL_OCTET:
    case IDL_UINT8:
      return "uint8_t";
    case IDL_SHORT:
    case IDL_INT16:
      return "int16_t";
    case IDL_USHORT:
    case IDL_UINT16:
      return "uint16_t";
    case IDL_LONG:
    case IDL_INT32:
      return "int32_t";
    case IDL_ULONG:
    case IDL_UINT32:
      return "uint32_t";
    case IDL_LLONG:
    case IDL_INT64:
      return "int64_t";
    case IDL_ULLONG:
    case IDL_UINT64:
      return "uint64_t";
    case IDL_FLOAT:
      return "float";
    case IDL_DOUBLE:
      return "double";
    default:
      return NULL;
  }
}

static void print_type(struct output* out, const void* type) {
  if (idl_is_sequence(type)) {
    print(out, "std::vector<");
    print_type(out, ((const idl_sequence_t*)type)->type_spec);
    print(out, ">");
  } else if (idl_is_string(type)) {
    print(out, "std::string");
  } else if (idl_is_alias(type) || idl_is_struct(type) || idl_is_enum(type)) {
    print_scoped(out, type, false);
  } else if (idl_is_base_type(type) && base_type(idl_type(type)) != NULL) {
    print(out, "%s", base_type(idl_type(type)));
  } else {
    refuse(out, type, "unions, bit masks and wide characters");
  }
}

static void print_dimensions(struct output* out, const idl_literal_t* dimension, const void* type) {
  if (dimension == NULL) {
    print_type(out, type);
    return;
  }
  print(out, "std::array<");
  print_dimensions(out, idl_next(dimension), type);
  print(out, ", %" PRIu32 ">", dimension->value.uint32);
}

// A declarator's type, with the dimensions of arrays.
static void print_declared(struct output* out, const void* type, const idl_declarator_t* declarator) {
  print_dimensions(out, (const idl_literal_t*)declarator->const_expr, type);
}

// True for a number or enumeration, which accessors return by value.
static bool is_plain(const void* type, const idl_declarator_t* declarator) {
  if (declarator->const_expr != NULL) return false;
  while (idl_is_alias(type)) {
    if (((const idl_declarator_t*)type)->const_expr != NULL) return false;
    type = ((const idl_typedef_t*)idl_parent(type))->type_spec;
  }
  return idl_is_base_type(type) || idl_is_enum(type);
}

static void print_literal(struct output* out, const idl_const_t* constant) {
  const void* value = constant->const_expr;
  if (idl_is_enumerator(value)) {
    print_scoped(out, idl_parent(value), false);
    print(out, "::%s", idl_identifier(value));
    return;
  }
  const idl_literal_t* literal = value;
  switch (idl_type(literal)) {
    case IDL_BOOL:
      print(out, "%s", literal->value.bln ? "true" : "false");
      break;
    case IDL_CHAR:
      if (!isprint((unsigned char)literal->value.chr) || literal->value.chr == '\'' ||
          literal->value.chr == '\\') {
        refuse(out, constant, "character constants that idlc cannot write into its header for C");
      }
      print(out, "static_cast<char>(%d)", literal->value.chr);
      break;
    case IDL_INT8:
      print(out, "%d", literal->value.int8);
      break;
    case IDL_OCTET:
    case IDL_UINT8:
      print(out, "%d", literal->value.uint8);
      break;
    case IDL_SHORT:
    case IDL_INT16:
      print(out, "%d", literal->value.int16);
      break;
    case IDL_USHORT:
    case IDL_UINT16:
      print(out, "%d", literal->value.uint16);
      break;
    case IDL_LONG:
    case IDL_INT32:
      // The smallest number has no literal.
      print(out, literal->value.int32 == INT32_MIN ? "-2147483647 - 1" : "%" PRId32, literal->value.int32);
      break;
    case IDL_ULONG:
    case IDL_UINT32:
      print(out, "%" PRIu32 "U", literal->value.uint32);
      break;
    case IDL_LLONG:
    case IDL_INT64:
      print(out, literal->value.int64 == INT64_MIN ? "-9223372036854775807LL - 1" : "%" PRId64 "LL",
            literal->value.int64);
      break;
    case IDL_ULLONG:
    case IDL_UINT64:
      print(out, "%" PRIu64 "ULL", literal->value.uint64);
      break;
    case IDL_FLOAT:
      print(out, "static_cast<float>(%.9g)", (double)literal->value.flt);
      break;
    case IDL_DOUBLE:
      print(out, "static_cast<double>(%.17g)", literal->value.dbl);
      break;
    case IDL_STRING:
      print(out, "\"");
      for (const char* each = literal->value.str; *each != '\0'; ++each) {
        if (isprint((unsigned char)*each) && *each != '"' && *each != '\\') {
          print(out, "%c", *each);
        } else {
          print(out, "\\%03o", (unsigned char)*each);
        }
      }
      print(out, "\"");
      break;
    default:
      refuse(out, constant, "constants of this type");
  }
}

static void print_const(struct output* out, const idl_const_t* constant) {
  print(out, "const ");
  print_type(out, constant->type_spec);
  print(out, " %s = ", name_of(out, constant));
  print_literal(out, constant);
  print(out, ";\n\n");
}

static void print_enum(struct output* out, const idl_enum_t* type) {
  print(out, "enum class %s {", name_of(out, type));
  for (const idl_enumerator_t* each = type->enumerators; each != NULL; each = idl_next(each)) {
    print(out, "%s\n  %s = %" PRIu32, each == type->enumerators ? "" : ",", name_of(out, each),
          each->value.value);
  }
  print(out, "\n};\n\n");
}

static void print_typedef(struct output* out, const idl_typedef_t* alias) {
  for (const idl_declarator_t* each = alias->declarators; each != NULL; each = idl_next(each)) {
    print(out, "typedef ");
    print_declared(out, alias->type_spec, each);
    print(out, " %s;\n\n", name_of(out, each));
  }
}

// Calls `visit` for each field of a struct.
static void each_field(struct output* out, const idl_struct_t* type,
                       void (*visit)(struct output*, const void* type, const idl_declarator_t*,
                                     bool is_first)) {
  bool is_first = true;
  for (const idl_member_t* member = type->members; member != NULL; member = idl_next(member)) {
    for (const idl_declarator_t* each = member->declarators; each != NULL; each = idl_next(each)) {
      visit(out, member->type_spec, each, is_first);
      is_first = false;
    }
  }
}

static void print_data(struct output* out, const void* type, const idl_declarator_t* field, bool is_first) {
  (void)is_first;
  print(out, "  ");
  print_declared(out, type, field);
  print(out, " %s_", name_of(out, field));
  const void* stripped = idl_strip(type, IDL_STRIP_ALIASES);
  if (field->const_expr == NULL && stripped != NULL && idl_is_enum(stripped)) {
    print(out, " = ");
    print_scoped(out, stripped, false);
    print(out, "::%s;\n", idl_identifier(((const idl_enum_t*)stripped)->enumerators));
  } else {
    print(out, "{};\n");
  }
}

static void print_parameter(struct output* out, const void* type, const idl_declarator_t* field,
                            bool is_first) {
  const bool plain = is_plain(type, field);
  print(out, "%s\n      %s", is_first ? "" : ",", plain ? "" : "const ");
  print_declared(out, type, field);
  print(out, "%s %s", plain ? "" : "&", idl_identifier(field));
}

static void print_initializer(struct output* out, const void* type, const idl_declarator_t* field,
                              bool is_first) {
  (void)type;
  print(out, "%s%s_(%s)", is_first ? "\n      : " : ",\n        ", idl_identifier(field),
        idl_identifier(field));
}

static void print_accessors(struct output* out, const void* type, const idl_declarator_t* field,
                            bool is_first) {
  (void)is_first;
  const char* name = idl_identifier(field);
  const bool plain = is_plain(type, field);
  print(out, plain ? "  " : "  const ");
  print_declared(out, type, field);
  print(out, "%s %s() const { return this->%s_; }\n  ", plain ? "" : "&", name, name);
  print_declared(out, type, field);
  print(out, "& %s() { return this->%s_; }\n", name, name);
  print(out, plain ? "  void %s(" : "  void %s(const ", name);
  print_declared(out, type, field);
  print(out, "%s _val_) { this->%s_ = _val_; }\n", plain ? "" : "&", name);
  if (plain) return;
  print(out, "  void %s(", name);
  print_declared(out, type, field);
  print(out, "&& _val_) { this->%s_ = std::move(_val_); }\n", name);
}

static void print_struct(struct output* out, const idl_struct_t* type) {
  const char* name = name_of(out, type);
  if (type->inherit_spec != NULL) refuse(out, type, "derived structs");
  for (const idl_member_t* member = type->members; member != NULL; member = idl_next(member)) {
    if (member->optional.value) refuse(out, member, "optional members");
    if (member->external.value) refuse(out, member, "external members");
    if (member->value.annotation != NULL) refuse(out, member, "default values of members");
  }
  print(out, "class %s {\nprivate:\n", name);
  each_field(out, type, print_data);
  print(out, "\npublic:\n  %s() = default;\n\n", name);
  if (type->members != NULL) {
    print(out, "  explicit %s(", name);
    each_field(out, type, print_parameter);
    print(out, ")");
    each_field(out, type, print_initializer);
    print(out, " {}\n\n");
  }
  each_field(out, type, print_accessors);
  print(out, "\n  bool operator==(const %s& _other) const = default;\n};\n\n", name);
}

// Refuses bounds that no conversion checks: those of sequences in arrays and sequences.
static void check_inner_bounds(struct output* out, const void* type, bool is_inner) {
  while (idl_is_alias(type)) {
    if (((const idl_declarator_t*)type)->const_expr != NULL) is_inner = true;
    type = ((const idl_typedef_t*)idl_parent(type))->type_spec;
  }
  if (!idl_is_sequence(type)) return;
  if (is_inner && ((const idl_sequence_t*)type)->maximum != 0) {
    refuse(out, type, "bounded sequences in arrays and sequences");
  }
  check_inner_bounds(out, ((const idl_sequence_t*)type)->type_spec, true);
}

static void print_visit(struct output* out, const void* type, const idl_declarator_t* field, bool is_first) {
  (void)is_first;
  const char* name = idl_identifier(field);
  check_inner_bounds(out, type, field->const_expr != NULL);
  print(out, "    visit(\"%s\", sample.%s(), c.%s", name, name, name);
  const void* stripped = field->const_expr == NULL ? idl_strip(type, IDL_STRIP_ALIASES) : NULL;
  if (stripped != NULL && idl_is_sequence(stripped) && ((const idl_sequence_t*)stripped)->maximum != 0) {
    print(out, ", %" PRIu32, ((const idl_sequence_t*)stripped)->maximum);
  }
  print(out, ");\n");
}

static void print_conversions(struct output* out, const idl_struct_t* type) {
  print(out, "template <>\nstruct dds::topic::detail::TypeSupport<");
  print_scoped(out, type, false);
  print(out, "> {\n  using C = ::");
  print_scoped(out, type, true);
  print(out, ";\n");
  if (idl_is_topic(type, (out->state->config.flags & IDL_FLAG_KEYLIST) != 0)) {
    print(out, "  static const dds_topic_descriptor_t& descriptor() { return ::");
    print_scoped(out, type, true);
    print(out, "_desc; }\n");
  }
  print(out,
        "  template <class Visitor, class Sample, class Struct>\n"
        "  static void fields([[maybe_unused]] Visitor& visit, [[maybe_unused]] Sample& sample,\n"
        "                     [[maybe_unused]] Struct& c) {\n");
  each_field(out, type, print_visit);
  print(out, "  }\n};\n\n");
}

// True unless the definition is of an included file, which has a header of its own.
static bool is_of_this_file(const struct output* out, const void* node) {
  return strcmp(idl_location(node)->first.source->path->name, out->state->sources->path->name) == 0;
}

static void print_definitions(struct output* out, const void* first) {
  for (const void* node = first; node != NULL; node = idl_next(node)) {
    if (!is_of_this_file(out, node)) continue;
    if (idl_is_module(node)) {
      print(out, "namespace %s {\n\n", name_of(out, node));
      print_definitions(out, ((const idl_module_t*)node)->definitions);
      print(out, "}  // namespace %s\n\n", idl_identifier(node));
    } else if (idl_is_const(node)) {
      print_const(out, node);
    } else if (idl_is_typedef(node)) {
      print_typedef(out, node);
    } else if (idl_is_enum(node)) {
      print_enum(out, node);
    } else if (idl_is_struct(node)) {
      print_struct(out, node);
    } else if (idl_is_union(node) || idl_is_bitmask(node)) {
      refuse(out, node, "unions and bit masks");
    }
  }
}

static void print_all_conversions(struct output* out, const void* first) {
  for (const void* node = first; node != NULL; node = idl_next(node)) {
    if (!is_of_this_file(out, node)) continue;
    if (idl_is_module(node)) print_all_conversions(out, ((const idl_module_t*)node)->definitions);
    if (idl_is_struct(node)) print_conversions(out, node);
  }
}

// Returns the name of a file without folders and ending, to be freed.
static char* stem_of(const char* path) {
  const char* slash = strrchr(path, '/');
  char* stem = strdup(slash == NULL ? path : slash + 1);
  char* dot = stem == NULL ? NULL : strrchr(stem, '.');
  if (dot != NULL) *dot = '\0';
  return stem;
}

static void print_file(struct output* out, const char* stem) {
  print(out, "// Generated from %s.idl by sonopose.\n#ifndef DDSCXX_", stem);
  char guard[256];
  size_t length = 0;
  for (; stem[length] != '\0' && length < sizeof(guard) - 1; ++length) {
    guard[length] = isalnum((unsigned char)stem[length]) ? (char)toupper((unsigned char)stem[length]) : '_';
  }
  guard[length] = '\0';
  print(out, "%s_HPP\n#define DDSCXX_%s_HPP\n\n", guard, guard);
  print(out, "#ifdef DDSCXX_%s_HPP_EXCLUDED\n", guard);
  print(out,
        "#error \"this file includes another header whose types have the names of those in "
        "%s.hpp\"\n#endif\n\n",
        stem);
  for (const idl_source_t* each = out->state->sources->includes; each != NULL; each = each->next) {
    char* included = stem_of(each->path->name);
    if (included == NULL) out->failed = true;
    if (included != NULL) print(out, "#include \"%s.hpp\"\n", included);
    free(included);
  }
  print(out, "#include \"%s.h\"\n\n#include <dds/topic/detail/TypeSupport.hpp>\n\n", stem);
  print(out,
        "#include <array>\n#include <cstdint>\n#include <string>\n#include <utility>\n#include <vector>\n\n");
  print_definitions(out, out->state->root);
  print_all_conversions(out, out->state->root);
  print(out, "#endif  // DDSCXX_%s_HPP\n", guard);
}

idl_retcode_t generate(const idl_pstate_t* state, const idlc_generator_config_t* config) {
  char* stem = stem_of(state->sources->path->name);
  char path[4096];
  if (stem == NULL) return IDL_RETCODE_NO_MEMORY;
  const bool has_folder = config != NULL && config->output_dir != NULL && config->output_dir[0] != '\0';
  const int length = snprintf(path, sizeof(path), "%s%s%s.hpp", has_folder ? config->output_dir : "",
                              has_folder ? "/" : "", stem);
  if (length < 0 || (size_t)length >= sizeof(path)) {
    fprintf(stderr, "%s.hpp: the path is too long\n", stem);
    free(stem);
    return IDL_RETCODE_BAD_PARAMETER;
  }
  struct output out = {.file = fopen(path, "w"), .state = state, .refused = {NULL}, .failed = false};
  if (out.file == NULL) {
    fprintf(stderr, "%s: cannot be written\n", path);
    free(stem);
    return IDL_RETCODE_NO_ACCESS;
  }
  print_file(&out, stem);
  if (fclose(out.file) != 0) out.failed = true;
  free(stem);
  if (!out.failed) return IDL_RETCODE_OK;
  remove(path);
  return IDL_RETCODE_SEMANTIC_ERROR;
}
