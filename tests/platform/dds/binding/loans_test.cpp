#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <iterator>
#include <type_traits>
#include <utility>

namespace sonopose::dds::test::loans_test {

using Command = sonopose_ResetCommand;

static_assert(!std::is_copy_constructible_v<LoanedSamples<Command>>);
static_assert(std::is_nothrow_move_constructible_v<LoanedSamples<Command>>);
static_assert(std::input_or_output_iterator<LoanedSamples<Command>::Iterator>);

// Cyclone DDS reuses one loan buffer per reader, so its address shows whether a loan was returned.
TEST_CASE("A loan is returned when its owner is destroyed, and not earlier") {
  GIVEN("samples in a reader") {
    const DomainParticipant member = participant();
    const Topic<Command> topic(member, "test/loans");
    const Qos qos = Qos() << policy::Reliability::reliable() << policy::History::keep_last(16);
    DataReader<Command> reader(member, topic, qos);
    DataWriter<Command> writer(member, topic, qos);
    REQUIRE(matched(reader));
    for (std::uint64_t id = 1; id <= 4; ++id) writer.write(command(7, id));
    const Command* first_buffer = nullptr;
    {
      const LoanedSamples<Command> loan = reader.take(1);
      REQUIRE(loan.size() == 1);
      first_buffer = &loan[0].data();
    }

    WHEN("a loan has ended") {
      const LoanedSamples<Command> next = reader.take(1);
      THEN("its memory is lent again") {
        CHECK(&next[0].data() == first_buffer);
      }
    }
    WHEN("a loan is held while more is taken") {
      const LoanedSamples<Command> held = reader.take(1);
      const LoanedSamples<Command> next = reader.take(1);
      THEN("both keep their data") {
        CHECK(&held[0].data() != &next[0].data());
        CHECK(held[0].data().request_id == 2);
        CHECK(next[0].data().request_id == 3);
      }
    }
    WHEN("a loan is moved") {
      LoanedSamples<Command> from = reader.take(1);
      LoanedSamples<Command> to = std::move(from);
      THEN("the new holder has it, and gives it back") {
        CHECK(from.empty());  // NOLINT(bugprone-use-after-move,clang-analyzer-cplusplus.Move)
        REQUIRE(to.size() == 1);
        CHECK(to[0].data().request_id == 2);
        to = LoanedSamples<Command>();
        CHECK(&reader.take(1)[0].data() == first_buffer);
      }
    }
    WHEN("it is given back by hand") {
      LoanedSamples<Command> loan = reader.take(1);
      loan.return_loan();
      loan.return_loan();
      THEN("it is empty and the memory is lent again") {
        CHECK(loan.empty());
        CHECK(loan.begin() == loan.end());
        CHECK(&reader.take(1)[0].data() == first_buffer);
      }
    }
    WHEN("nothing is left to take") {
      while (!reader.take(1).empty()) {
      }
      THEN("no loan is out") {
        CHECK(reader.take(1).empty());
        writer.write(command(7, 9));
        CHECK(&reader.take(1)[0].data() == first_buffer);
      }
    }
  }
}

}  // namespace sonopose::dds::test::loans_test
