// Which block moves when: in place, once all blocks that read it have their forces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace fluxpact {

/// Each thread has a range of blocks and goes through it in order: forces of a block, then the
/// moves of those whose last reader that was. What another thread reads moves after all forces.
class BlockTurns {
 public:
  /// `partners(b)`: the blocks whose particles block b reads, in any order.
  template <class Partners>
  void plan(int blocks, int threads, const Partners& partners) {
    threads_ = threads;
    last_reader_.resize(blocks);
    room_.resize(blocks);
    rooms_ = 0;
    for (int t = 0; t < threads; ++t) {
      for (int b = first(t); b < first(t + 1); ++b) last_reader_[b] = b;
    }
    for (int t = 0; t < threads; ++t) {
      for (int b = first(t); b < first(t + 1); ++b) {
        for (const int read : partners(b)) {
          const bool own = first(t) <= read && read < first(t + 1);
          last_reader_[read] = own ? std::max(last_reader_[read], b) : blocks;
        }
      }
    }
    for (int t = 0; t < threads; ++t) give_rooms(first(t), first(t + 1));
  }
  int threads() const { return threads_; }
  /// The first block of a thread; that of the next one is its end.
  int first(int thread) const {
    return static_cast<int>(static_cast<std::int64_t>(last_reader_.size()) * thread / threads_);
  }
  /// The block of the same thread after whose forces a block may move; the number of blocks if that
  /// is after all forces.
  int last_reader(int block) const { return last_reader_[block]; }
  /// Where the sums of a block wait for its move, and how many rooms each thread needs.
  int room(int block) const { return room_[block]; }
  int rooms() const { return rooms_; }

 private:
  void give_rooms(int begin, int end) {
    free_.clear();
    int used = 0;
    for (int b = begin; b < end; ++b) {
      if (free_.empty()) free_.push_back(used++);
      room_[b] = free_.back();
      free_.pop_back();
      for (int c = begin; c <= b; ++c) {
        if (last_reader_[c] == b) free_.push_back(room_[c]);
      }
    }
    rooms_ = std::max(rooms_, used);
  }

  std::vector<int> last_reader_;
  std::vector<int> room_;
  std::vector<int> free_;
  int threads_ = 1;
  int rooms_ = 0;
};

}  // namespace fluxpact
