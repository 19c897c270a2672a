// Who is next: a tournament of the times of the next event of each particle. O(log n) to change
// one, O(1) to ask (Marin, Risso & Cordero, J. Comput. Phys. 109, 1993, 306-317).
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace fluxpact {

class EventQueue {
 public:
  /// Nothing happens to any of `count` particles.
  void reset(int count) {
    leaves_ = 1;
    while (leaves_ < count) leaves_ *= 2;
    time_.assign(static_cast<std::size_t>(leaves_), std::numeric_limits<double>::infinity());
    winner_.resize(static_cast<std::size_t>(leaves_));
    for (int node = leaves_ - 1; node >= 1; --node) winner_[node] = better(node);
  }

  /// The time of a particle's next event, infinity for none. Of two at one time the lower comes
  /// first.
  void set(int particle, double time) {
    time_[particle] = time;
    for (int node = (leaves_ + particle) / 2; node >= 1; node /= 2) {
      const int winner = better(node);
      if (winner == winner_[node] && winner != particle) return;
      winner_[node] = winner;
    }
  }

  int first() const { return leaves_ > 1 ? winner_[1] : 0; }
  double time(int particle) const { return time_[particle]; }

 private:
  int player(int node) const { return node >= leaves_ ? node - leaves_ : winner_[node]; }
  int better(int node) const {
    const int left = player(2 * node);
    const int right = player(2 * node + 1);
    return time_[left] <= time_[right] ? left : right;
  }

  int leaves_ = 1;
  std::vector<double> time_;
  std::vector<int> winner_;
};

}  // namespace fluxpact
