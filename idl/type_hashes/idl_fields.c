#include "idl_fields.h"

#include <idl/processor.h>
#include <idl/tree.h>
#include <stdio.h>

enum { name_size = 512 };

struct visitor {
  void (*on_field)(void* user, const struct idl_field* field);
  void* user;
};

// REP-2011's numbers: of plain types, and what makes arrays and sequences of them.
enum {
  nested_id = 1,
  string_id = 17,
  bounded_string_id = 21,
  array_offset = 48,
  bounded_sequence_offset = 96,
  unbounded_sequence_offset = 144
};

static int base_id(idl_type_t type) {
  switch (type) {
    case IDL_INT8:
      return 2;
    case IDL_UINT8:
      return 3;
    case IDL_INT16:
    case IDL_SHORT:
      return 4;
    case IDL_UINT16:
    case IDL_USHORT:
      return 5;
    case IDL_INT32:
    case IDL_LONG:
      return 6;
    case IDL_UINT32:
    case IDL_ULONG:
      return 7;
    case IDL_INT64:
    case IDL_LLONG:
      return 8;
    case IDL_UINT64:
    case IDL_ULLONG:
      return 9;
    case IDL_FLOAT:
      return 10;
    case IDL_DOUBLE:
      return 11;
    case IDL_BOOL:
      return 15;
    case IDL_OCTET:
      return 16;
    default:
      return 0;
  }
}

static void write_name(const void* type, char* name) {
  const void* scope = idl_parent(type);
  while (scope != NULL && !idl_is_module(scope)) scope = idl_parent(scope);
  if (scope == NULL) {
    snprintf(name, name_size, "%s", idl_identifier(type));
    return;
  }
  char before[name_size];
  write_name(scope, before);
  snprintf(name, name_size, "%.200s::%.200s", before, idl_identifier(type));
}

// `nested` has room for a name.
static void read_element(const void* spec, struct idl_field* field, char* nested) {
  if (idl_is_struct(spec)) {
    field->type_id = nested_id;
    write_name(spec, nested);
  } else if (idl_is_string(spec)) {
    field->string_capacity = ((const idl_string_t*)spec)->maximum;
    field->type_id = field->string_capacity == 0 ? string_id : bounded_string_id;
  } else {
    field->type_id = base_id(idl_type(spec));
  }
}

static void visit_declarator(const char* owner, const void* spec, const idl_declarator_t* declarator,
                             const struct visitor* visitor) {
  char nested[name_size] = "";
  struct idl_field field = {.owner = owner, .name = idl_identifier(declarator), .nested = nested};
  if (idl_is_sequence(spec)) {
    const idl_sequence_t* sequence = spec;
    read_element(sequence->type_spec, &field, nested);
    field.capacity = sequence->maximum;
    if (field.type_id != 0) {
      field.type_id += sequence->maximum == 0 ? unbounded_sequence_offset : bounded_sequence_offset;
    }
  } else {
    read_element(spec, &field, nested);
    if (idl_is_array(declarator)) {
      field.capacity = idl_array_size(declarator);
      if (field.type_id != 0) field.type_id += array_offset;
    }
  }
  visitor->on_field(visitor->user, &field);
}

static void visit_struct(const idl_struct_t* type, const struct visitor* visitor) {
  char owner[name_size];
  write_name(type, owner);
  for (const idl_member_t* member = type->members; member != NULL; member = idl_next(member)) {
    for (const idl_declarator_t* each = member->declarators; each != NULL; each = idl_next(each)) {
      visit_declarator(owner, member->type_spec, each, visitor);
    }
  }
}

static void visit_definitions(const void* first, const struct visitor* visitor) {
  for (const void* node = first; node != NULL; node = idl_next(node)) {
    if (idl_is_module(node)) visit_definitions(((const idl_module_t*)node)->definitions, visitor);
    if (idl_is_struct(node)) visit_struct(node, visitor);
  }
}

int idl_each_field(const char* text, void (*on_field)(void* user, const struct idl_field* field),
                   void* user) {
  const struct visitor visitor = {on_field, user};
  idl_pstate_t* state = NULL;
  int result = idl_create_pstate(IDL_FLAG_ANNOTATIONS | IDL_FLAG_EXTENDED_DATA_TYPES, NULL, &state);
  if (result != 0) return result;
  result = idl_parse_string(state, text);
  if (result == 0) visit_definitions(state->root, &visitor);
  idl_delete_pstate(state);
  return result;
}
