/// The place that our function takes in Cyclone DDS. A wait of 100 s and a second handshake, which end a
/// process without it, are too long for a test.

#include <sonopose/dds/binding/domain.hpp>

#include <catch2/catch.hpp>
#include <dds/dds.h>

#include <dlfcn.h>
#include <string>

namespace handshake_limit_test {

std::string library_of(const void* function) {
  Dl_info found{};
  REQUIRE(::dladdr(function, &found) != 0);
  return found.dli_fname;
}

TEST_CASE("Handshakes have no limit of time, at which Cyclone DDS 0.10.2 would use freed memory") {
  const void* const used = ::dlsym(RTLD_DEFAULT, "dds_security_fsm_set_timeout");
  REQUIRE(used != nullptr);
  CHECK(library_of(used) != library_of(reinterpret_cast<const void*>(&dds_create_participant)));
}

}  // namespace handshake_limit_test
