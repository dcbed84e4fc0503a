// The fields of all structs in an IDL text, as idlc's own parser reads them. In C, since that parser's
// headers are no C++.

#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Names are those of the wire, "pkg::msg::dds_::Name_".
struct idl_field {
  const char* owner;         // the struct
  const char* name;          // of the field
  int type_id;               // REP-2011's number, arrays and sequences included; 0: of a type that has none
  uint32_t capacity;         // of an array or a bounded sequence, else 0
  uint32_t string_capacity;  // of a bounded string, else 0
  const char* nested;        // the struct that it is made of, else empty
};

// Calls `on_field(user, field)` for each, in the order of the text; what `field` points to is gone after the
// call. Returns 0, or what idlc's parser returned, which has said why on stderr.
int idl_each_field(const char* text, void (*on_field)(void* user, const struct idl_field* field), void* user);

#ifdef __cplusplus
}
#endif
