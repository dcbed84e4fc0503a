#include "dds/dds_fixture.hpp"

#include <catch2/catch.hpp>

#include <type_traits>
#include <utility>

namespace sonopose::dds::test::move_test {

using Command = sonopose_ResetCommand;

template <class Entity>
constexpr bool move_only =
    std::is_nothrow_move_constructible_v<Entity>&& std::is_nothrow_move_assignable_v<Entity> &&
    !std::is_copy_constructible_v<Entity> && !std::is_copy_assignable_v<Entity>;

static_assert(move_only<DomainParticipant>);
static_assert(move_only<DataWriter<Command>>);
static_assert(move_only<DataReader<Command>>);
static_assert(move_only<WaitSet> && move_only<GuardCondition> && move_only<ReadCondition>);
static_assert(std::is_move_constructible_v<Topic<Command>> && !std::is_copy_constructible_v<Topic<Command>>);
static_assert(std::is_copy_constructible_v<Qos>);

/// Returns true if Cyclone DDS still knows the handle.
bool exists(dds_entity_t handle) {
  return dds_get_parent(handle) >= 0;
}

TEST_CASE("An entity has one owner and is deleted with it") {
  const DomainParticipant member = participant();
  const Topic<Command> topic(member, "test/moves");
  DataWriter<Command> first(member, topic);
  const dds_entity_t handle = first.handle();

  SECTION("moving transfers the entity") {
    DataWriter<Command> second = std::move(first);
    CHECK(first.is_nil());  // NOLINT(bugprone-use-after-move,clang-analyzer-cplusplus.Move)
    CHECK(second.handle() == handle);
    CHECK(exists(handle));
    second.write(command(7, 1));
  }
  SECTION("assigning deletes the previous entity") {
    DataWriter<Command> second(member, topic);
    const dds_entity_t replaced = second.handle();
    second = std::move(first);
    CHECK_FALSE(exists(replaced));
    CHECK(second.handle() == handle);
    CHECK(exists(handle));
  }
  SECTION("destruction deletes, once") {
    // Each section moves its own writer, which the analysis does not see.
    { const DataWriter<Command> last = std::move(first); }  // NOLINT(bugprone-use-after-move)
    CHECK_FALSE(exists(handle));
  }
  SECTION("a borrowed view deletes nothing") {
    {
      DataWriter<Command> view = DataWriter<Command>::borrow(handle);
      view.write(command(7, 1));
      const DataWriter<Command> moved = std::move(view);
      CHECK(moved.handle() == handle);
    }
    CHECK(exists(handle));
  }
  SECTION("a moved reader is matched as before") {
    DataReader<Command> reader(member, topic, Qos() << policy::Reliability::reliable());
    DataReader<Command> moved = std::move(reader);
    REQUIRE(matched(moved));
    first.write(command(7, 5));  // NOLINT(bugprone-use-after-move)
    CHECK(take_samples(moved, 1).at(0).request_id == 5);
  }
}

TEST_CASE("A topic may be destroyed before its writer") {
  const DomainParticipant member = participant();
  DataWriter<Command> writer;
  DataReader<Command> reader;
  {
    const Topic<Command> topic(member, "test/topic_gone");
    writer = DataWriter<Command>(member, topic, Qos() << policy::Reliability::reliable());
    reader = DataReader<Command>(member, topic, Qos() << policy::Reliability::reliable());
  }
  REQUIRE(matched(reader));
  writer.write(command(7, 3));
  CHECK(take_samples(reader, 1).at(0).request_id == 3);
}

TEST_CASE("A participant may be replaced by another domain's") {
  DomainParticipant member = participant();
  const dds_entity_t before = member.handle();
  const sonopose::test::TestDomain other;
  member = make_participant({.domain_id = other.id()});
  CHECK(member.domain_id() == other.id());
  CHECK_FALSE(exists(before));
  // The first domain is closed, so it can be opened with another configuration.
  CHECK_NOTHROW(make_participant({.domain_id = test_domain(), .network = Network::lan}));
}

}  // namespace sonopose::dds::test::move_test
