#include "counting_consumer.hpp"

#include <sonopose/dds/topics/topics.hpp>

#include <new>
#include <stdexcept>
#include <sys/mman.h>
#include <unistd.h>

namespace sonopose::benchmarks {
namespace {

/// Takes the samples of a topic and counts them.
template <class T>
class Counter final : public dds::DataReaderListener<T> {
public:
  explicit Counter(std::atomic<std::uint64_t>& count) : count_(count) {}
  void on_data_available(dds::DataReader<T>& reader) noexcept override {
    reader.try_take_each(
        [this](const T&, const dds::SampleInfo&) { count_.fetch_add(1, std::memory_order_relaxed); });
  }

private:
  std::atomic<std::uint64_t>& count_;
};

template <class T>
struct CountingReader {
  CountingReader(const dds::DomainParticipant& participant, const dds::qos::Provider& qos,
                 const dds::topics::Entry<T>& entry, std::atomic<std::uint64_t>& count)
      : listener(count), reader(dds::topics::make_reader(participant, qos, entry, &listener)) {}
  Counter<T> listener;
  dds::DataReader<T> reader;
};

}  // namespace

std::atomic<std::uint64_t>& shared_counter() {
  void* const memory = ::mmap(nullptr, sizeof(std::atomic<std::uint64_t>), PROT_READ | PROT_WRITE,
                              MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("mmap failed");
  return *new (memory) std::atomic<std::uint64_t>(0);
}

void count_samples(std::uint32_t domain, std::atomic<std::uint64_t>& count) {
  namespace topics = dds::topics;
  const dds::qos::Provider qos;
  const dds::DomainParticipant participant({domain, dds::Network::loopback});
  const CountingReader pose(participant, qos, topics::pose, count);
  const CountingReader truth(participant, qos, topics::truth, count);
  const CountingReader report(participant, qos, topics::report, count);
  const CountingReader beacon_status(participant, qos, topics::beacon_status, count);
  const CountingReader estimate(participant, qos, topics::estimate, count);
  const CountingReader fusion_status(participant, qos, topics::fusion_status, count);
  const CountingReader line_status(participant, qos, topics::line_status, count);
  const CountingReader log(participant, qos, topics::log, count);
  while (true) ::pause();
}

}  // namespace sonopose::benchmarks
