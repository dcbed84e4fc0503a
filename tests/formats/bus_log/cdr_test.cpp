#include <sonopose/dds/psm/cdr.hpp>
#include <sonopose/dds/topics/conversions.hpp>
#include <sonopose/dds/topics/topics.hpp>

#include <catch2/catch.hpp>

namespace sonopose::cdr_test {

using dds::CdrSample;

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

TEST_CASE("a serialized sample has the bytes of CDR in either byte order") {
  // address, 6 bytes of padding, request_id
  const sonopose_ResetCommand command{.address = 0x0102, .request_id = 0x0304};
  CHECK(dds::write_cdr(command, std::endian::little) ==
        bytes_of({0, 1, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 4, 3, 0, 0, 0, 0, 0, 0}));
  CHECK(dds::write_cdr(command, std::endian::big) ==
        bytes_of({0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 4}));
}

SCENARIO("samples are read from their serialized form") {
  const auto byte_order = GENERATE(std::endian::little, std::endian::big);
  GIVEN("an IMU sample") {
    const ImuSample sample{.address = 21,
                           .sequence = 1ULL << 40U,
                           .sensor_time_ns = 1'700'000'000'000'000'000,
                           .angular_velocity_body_radps = {0.1, -0.2, 0.3},
                           .specific_force_body_mps2 = {0, 0, 9.81},
                           .magnetic_field_body_t = Vector3d(1e-5, 2e-5, -3e-5),
                           .meaning = ImuMeaning::mean_since_last};
    const auto cdr = dds::write_cdr(dds::topics::to_idl(sample), byte_order);
    THEN("it is the same") {
      const CdrSample<sonopose_ImuSample> read(cdr);
      REQUIRE(read.get() != nullptr);
      CHECK(dds::topics::from_idl(*read.get()) == sample);
    }
    THEN("no shorter piece of it is a sample") {
      for (std::size_t size = 0; size < cdr.size(); ++size) {
        CAPTURE(size);
        CHECK(CdrSample<sonopose_ImuSample>(std::span(cdr).first(size)).get() == nullptr);
      }
    }
    THEN("another encoding is refused") {
      auto xcdr2 = cdr;
      xcdr2[1] = std::byte{7};
      CHECK(CdrSample<sonopose_ImuSample>(xcdr2).get() == nullptr);
    }
  }
  GIVEN("a sample with a list of texts") {
    const EffectiveSettings settings{.address = 7,
                                     .time_ns = 5,
                                     .from_sequence = 3,
                                     .values = {{"documented.trust.sigma_m", "0.1"}, {"a", ""}}};
    const auto view = dds::topics::to_idl(settings);
    const auto cdr = dds::write_cdr(view.sample(), byte_order);
    THEN("it is the same") {
      const CdrSample<sonopose_EffectiveSettings> read(cdr);
      REQUIRE(read.get() != nullptr);
      CHECK(dds::topics::from_idl(*read.get()).values == settings.values);
    }
    THEN("a list that claims more elements than there are is refused") {
      auto longer = cdr;
      longer[4 + 24] = longer[4 + 27] = std::byte{0x7f};  // the length follows three fields of eight bytes
      CHECK(CdrSample<sonopose_EffectiveSettings>(longer).get() == nullptr);
    }
  }
}

}  // namespace sonopose::cdr_test
