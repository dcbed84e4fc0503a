# Writes the table of ROS 2's type hashes (RIHS01: SHA-256): one C++ row {"wire name", "hash"} per type.
#
#   cmake -DDESCRIPTIONS=FILE -DTABLE=FILE -P hashes.cmake
#
# DESCRIPTIONS is the output of type_hashes/main.cpp: one line per type: wire name, space, description in JSON.
file(STRINGS ${DESCRIPTIONS} lines)
set(table "")
foreach(line IN LISTS lines)
  string(FIND "${line}" " " space)
  string(SUBSTRING "${line}" 0 ${space} wire_name)
  math(EXPR begin "${space} + 1")
  string(SUBSTRING "${line}" ${begin} -1 description)
  string(SHA256 hash "${description}")
  string(APPEND table "{\"${wire_name}\", \"${hash}\"},\n")
endforeach()
file(WRITE ${TABLE} "${table}")
