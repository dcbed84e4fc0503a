#!/usr/bin/env bash
# GIVEN an installation of this build in an empty folder
# WHEN the examples are configured with find_package(sonopose) alone, built and started; the consumer in plain C with
#   nothing but the installed IDL and loopback configuration, and the embedded engine with nothing but Eigen
# AND the C++ and CMake of the README, and the C++ of other pages, are pasted into files, and an IDL file of a user is
#   generated
# THEN the consumers receive poses of the installed bridge and, on its circle, of the example producer, and those of
#   ROS 2 from the relay; the embedded engine stays within 1 cm of its fixes, and an optional component dds is missing;
#   what was pasted compiles.
set -euo pipefail
build=$1 source=$2 cmake=$3
. "$source/tests/install/installation.sh"
flags=$(sed -n 's/^SONOPOSE_SANITIZE:STRING=//p' "$build/CMakeCache.txt")
share=$work/prefix/share/sonopose
eigen_only=(-DCMAKE_DISABLE_FIND_PACKAGE_CycloneDDS=ON -DCMAKE_DISABLE_FIND_PACKAGE_pugixml=ON
  -DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON -DCMAKE_DISABLE_FIND_PACKAGE_Threads=ON)

code_of() { # LANGUAGE PAGE
  awk -v fence="\`\`\`$1" '$0 == fence { inside = 1; next } /^```/ { inside = 0 } inside' "$source/$2"
}
mkdir "$work"/{optional,readme,pages,types}
cat >"$work/types/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(types LANGUAGES C CXX)
find_package(sonopose REQUIRED)
sonopose_idlcxx_generate(TARGET my_types FILES ${CMAKE_CURRENT_SOURCE_DIR}/mine.idl)
add_executable(types main.cpp)
target_link_libraries(types PRIVATE sonopose::cxx my_types)
END
echo 'module mine { @final struct Note { @key long id; string text; }; };' >"$work/types/mine.idl"
cat >"$work/types/main.cpp" <<'END'
#include "mine.hpp"
#include <dds/dds.hpp>
int main() {
  return dds::topic::topic_type_name<mine::Note>::value() == "mine::Note" && mine::Note(1, "a").text() == "a" ? 0 : 1;
}
END
cat >"$work/optional/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(optional LANGUAGES C CXX)
find_package(sonopose REQUIRED COMPONENTS estimation OPTIONAL_COMPONENTS dds)
if(sonopose_dds_FOUND)
  message(FATAL_ERROR "dds is found without Cyclone DDS")
endif()
END
code_of cpp README.md >"$work/readme/main.cpp"
code_of cmake README.md >"$work/readme/CMakeLists.txt"
for page in $(cd "$source" && grep -l '^```cpp' docs/*.md); do
  code_of cpp "$page" >"$work/pages/$(basename "$page" .md).cpp"
done
cat >"$work/pages/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(pages LANGUAGES C CXX)
find_package(sonopose REQUIRED)
file(GLOB pages *.cpp)
add_library(pages OBJECT ${pages})
target_compile_options(pages PRIVATE -fsyntax-only)
target_link_libraries(pages PRIVATE sonopose::dds sonopose::estimation)
END

# Each folder is a project of its own; below one that is common to several, CMake examines the compiler once.
build_together() { # NAME FOLDERS CMAKE-ARGUMENTS
  mkdir "$work/$1"
  {
    printf 'cmake_minimum_required(VERSION 3.25)\nproject(%s LANGUAGES C CXX)\n' "$1"
    for folder in $2; do printf 'add_subdirectory("%s" %s)\n' "$folder" "$(basename "$folder")"; done
  } >"$work/$1/CMakeLists.txt"
  "$cmake" -S "$work/$1" -B "$work/$1/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" \
    ${flags:+-DCMAKE_CXX_FLAGS=-fsanitize=$flags} "${@:3}" >/dev/null
  "$cmake" --build "$work/$1/build"
}
examples=$source/examples
cp -r "$examples/c_consumer" "$work/c_consumer"  # outside the source tree, where it finds the installed IDL
build_together on_the_bus "$examples/autopilot $examples/consumer $examples/producer $examples/ros2_listener_cyclone
  $work/c_consumer $work/readme $work/pages $work/types" -DSONOPOSE_DDS=own
build_together without_dds "$examples/embedded $work/optional" "${eigen_only[@]}"
bus=$work/on_the_bus/build

"$work/without_dds/build/embedded/sonopose_embedded" | tee "$work/embedded.log" | tail -n 1
tail -n 1 "$work/embedded.log" |
  awk '{ exit !($1 == 10 && ($3 - 2)^2 + ($4 - 1)^2 + ($5 - 0.5)^2 < 0.01^2) }'

"$bus/types/types"
. "$source/tests/install/reserve_domain.sh"
"$work/prefix/bin/sonopose-fusion" & pids+=($!)
"$work/prefix/bin/sonopose-ros2" & pids+=($!)
"$work/prefix/bin/sonopose-bridge" & pids+=($!)
for consumer in consumer/sonopose_consumer ros2_listener_cyclone/sonopose_ros2_listener; do
  poses=$(timeout 200 "$bus/$consumer" 50 | tee "$work/poses" | wc -l)
  tail -n 1 "$work/poses"
  [ "$poses" -ge 50 ]
done

kill -INT "${pids[2]}"
wait "${pids[2]}"
unset 'pids[2]'
"$bus/producer/sonopose_producer" & pids+=($!)
CYCLONEDDS_URI=file://$share/cyclonedds-loopback.xml \
  timeout 200 "$bus/c_consumer/sonopose_c_consumer" 500 >"$work/poses"
tail -n 1 "$work/poses" | tee "$work/pose"
awk '$1 == "42:" { exit !((sqrt($2^2 + $3^2) - 2)^2 < 0.2^2 && ($4 - 0.5)^2 < 0.2^2) } { exit 1 }' "$work/pose"
