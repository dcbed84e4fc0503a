#include "presence/address_set.hpp"

#include <catch2/catch.hpp>

#include <stdexcept>

namespace address_set_test {

using namespace sonopose;
using namespace sonopose::presence;

TEST_CASE("a set of addresses contains exactly its numbers and ranges") {
  const AddressSet set = AddressSet::parse("7-9,200,65534");
  for (const int address : {7, 8, 9, 200, 65534}) CHECK(set.contains(static_cast<BeaconAddress>(address)));
  for (const int address : {0, 6, 10, 199, 201, 65533})
    CHECK_FALSE(set.contains(static_cast<BeaconAddress>(address)));
}

TEST_CASE("a set knows whether it is a single beacon") {
  for (const char* const one : {"7", "7-7", "7,7", "65534"}) CHECK(AddressSet::parse(one).only_one());
  for (const char* const more : {"7-8", "7,8", "7-7,6-7"}) CHECK_FALSE(AddressSet::parse(more).only_one());
  CHECK_FALSE(AddressSet().only_one());
}

TEST_CASE("an empty set contains every beacon") {
  CHECK(AddressSet().contains(0));
  CHECK(AddressSet().contains(65534));
}

TEST_CASE("a set with another beacon contains it too, and one of every beacon stays so") {
  const AddressSet set = AddressSet::parse("7").with(65535);
  CHECK(set.contains(7));
  CHECK(set.contains(65535));
  CHECK_FALSE(set.contains(8));
  CHECK(AddressSet().with(65535).contains(8));
}

TEST_CASE("a malformed list of addresses is reported") {
  for (const char* text : {"", "7,", "x", "-3", "7-", "65535", "99999999999", "7 - 9", "1-2-3", "+7"}) {
    INFO(text);
    CHECK_THROWS_AS(AddressSet::parse(text), std::invalid_argument);
  }
  CHECK_THROWS_WITH(AddressSet::parse("5,7-x"), Catch::Contains("'7-x'") && Catch::Contains("65534"));
  CHECK_THROWS_WITH(AddressSet::parse("9-7"), Catch::Contains("'9-7'") && Catch::Contains("before"));
}

}  // namespace address_set_test
