#include "mcap/reader.hpp"
#include "mcap/record_file.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace sonopose::mcap {

/// Opens each block when its first message may be the next one, and takes the earliest next message of all
/// open blocks. In file order, one block of each file is open.
class Messages::Merge {
public:
  Merge(const Reader& reader, Selection selection) : reader_{reader}, selection_{std::move(selection)} {
    const auto& unreadable = reader.contents().unreadable_blocks;
    if (selection_.damaged == Selection::Damaged::refuse && !unreadable.empty()) {
      throw FormatError(unreadable.front());
    }
    for (const auto& [id, channel] : reader.channels()) {
      if (!selection_.channel || selection_.channel(channel)) channels_.insert(id);
    }
    for (const Block& block : reader.contents().blocks) {
      if (!is_selected(block)) continue;
      const std::size_t queue = is_by_time() ? 0 : block.file;
      if (queue >= queues_.size()) queues_.resize(queue + 1);
      queues_[queue].blocks.push_back(&block);
    }
    if (!is_by_time()) return;
    for (Queue& queue : queues_) {
      std::ranges::stable_sort(queue.blocks, {}, [](const Block* each) { return each->log_times.start_ns; });
    }
  }

  std::optional<Message> next() {
    close_finished();
    for (std::size_t i = 0; i < queues_.size(); ++i) {
      while (may_be_next(queues_[i])) open(*queues_[i].blocks[queues_[i].next++], i);
    }
    if (open_.empty()) return std::nullopt;
    std::ranges::pop_heap(open_, is_later);
    has_taken_ = true;
    OpenBlock& block = *open_.back();
    return block.loaded.message(block.loaded.messages[block.next++]);
  }

  [[nodiscard]] const std::vector<std::string>& skipped() const { return skipped_; }

private:
  /// Blocks that are opened one after another.
  struct Queue {
    std::vector<const Block*> blocks;
    std::size_t next = 0;  ///< the next one to open
    std::size_t open = 0;  ///< number of open ones
  };

  struct OpenBlock {
    std::pair<std::size_t, std::uint64_t> place;  ///< file and offset
    std::size_t queue = 0;
    LoadedBlock loaded;
    std::size_t next = 0;

    [[nodiscard]] std::uint64_t time_ns() const { return loaded.messages[next].log_time_ns; }
  };
  using Open = std::unique_ptr<OpenBlock>;

  static bool is_later(const Open& a, const Open& b) {
    return std::pair(a->time_ns(), a->place) > std::pair(b->time_ns(), b->place);
  }

  [[nodiscard]] bool is_by_time() const { return selection_.order == Selection::Order::log_time; }

  [[nodiscard]] bool is_selected(const Block& block) const {
    if (block.log_times.end_ns < selection_.start_ns || block.log_times.start_ns > selection_.end_ns) {
      return false;
    }
    return std::ranges::any_of(block.channels, [this](std::uint16_t id) { return channels_.contains(id); });
  }

  [[nodiscard]] bool may_be_next(const Queue& queue) const {
    if (queue.next == queue.blocks.size() || (!is_by_time() && queue.open > 0)) return false;
    return open_.empty() || queue.blocks[queue.next]->log_times.start_ns <= open_.front()->time_ns();
  }

  /// Closes the block of the last message, which is behind the heap, if it is finished.
  void close_finished() {
    if (!std::exchange(has_taken_, false)) return;
    OpenBlock& block = *open_.back();
    if (block.next < block.loaded.messages.size()) {
      std::ranges::push_heap(open_, is_later);
    } else {
      open_bytes_ -= block.loaded.size_bytes();
      --queues_[block.queue].open;
      open_.pop_back();
    }
  }

  void open(const Block& block, std::size_t queue) {
    auto opened = std::make_unique<OpenBlock>();
    opened->place = {block.file, block.offset};
    opened->queue = queue;
    try {
      opened->loaded = reader_.file(block.file).load(block);
      select(opened->loaded, block);
    } catch (const FormatError& error) {
      if (selection_.damaged == Selection::Damaged::refuse) throw;
      skipped_.emplace_back(error.what());
      return;
    }
    if (opened->loaded.messages.empty()) return;
    open_bytes_ += opened->loaded.size_bytes();
    if (open_bytes_ > selection_.max_bytes) {
      reader_.file(block.file)
          .place(block.offset)
          .fail("the chunks that overlap in time have " + std::to_string(open_bytes_) +
                " bytes, the limit is " + std::to_string(selection_.max_bytes));
    }
    ++queues_[queue].open;
    open_.push_back(std::move(opened));
    std::ranges::push_heap(open_, is_later);
  }

  void select(LoadedBlock& loaded, const Block& block) const {
    std::erase_if(loaded.messages, [&](const LoadedBlock::Item& item) {
      const auto id = reader_.channel_id(block.file, item.channel_id);
      // The scan has named messages of channels that were undefined at that point.
      if (block.was_scanned) return !id || !std::ranges::binary_search(block.channels, *id);
      if (id) return false;
      reader_.file(block.file)
          .place(block.offset)
          .fail("a message has channel " + std::to_string(item.channel_id) + ", which is not in the summary");
    });
    for (LoadedBlock::Item& item : loaded.messages) {
      item.channel_id = *reader_.channel_id(block.file, item.channel_id);
    }
    std::erase_if(loaded.messages, [this](const LoadedBlock::Item& item) {
      return item.log_time_ns < selection_.start_ns || item.log_time_ns > selection_.end_ns ||
             !channels_.contains(item.channel_id);
    });
    if (is_by_time()) std::ranges::stable_sort(loaded.messages, {}, &LoadedBlock::Item::log_time_ns);
  }

  const Reader& reader_;
  Selection selection_;
  std::set<std::uint16_t> channels_;
  std::vector<Queue> queues_;  ///< by time, one; in file order, one for each file
  std::vector<Open> open_;     ///< a heap
  std::uint64_t open_bytes_ = 0;
  bool has_taken_ = false;  ///< the last element is not in the heap
  std::vector<std::string> skipped_;
};

Messages::Messages(const Reader& reader, Selection selection)
    : merge_{std::make_unique<Merge>(reader, std::move(selection))} {}

Messages::~Messages() = default;

std::optional<Message> Messages::next() {
  return merge_->next();
}

const std::vector<std::string>& Messages::skipped() const {
  return merge_->skipped();
}

}  // namespace sonopose::mcap
