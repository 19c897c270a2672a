// Rows of four numbers turned into vector lanes and back: lane k of the four vectors holds the four
// numbers of row k. Included once for each instruction set, like contact_force-inl.hpp.
#if defined(FLUXPACT_ROW_LANES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef FLUXPACT_ROW_LANES_INL_
#undef FLUXPACT_ROW_LANES_INL_
#else
#define FLUXPACT_ROW_LANES_INL_
#endif

#include <hwy/highway.h>

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace fluxpact::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Four vectors: of rows while they are read, of components afterwards.
template <class V>
struct Quad {
  V a, b, c, d;
};

template <class D>
inline constexpr int lanes_of = static_cast<int>(hn::MaxLanes(D()));

/// True where the registers hold whole rows of four numbers, one or two of them.
template <class D>
inline constexpr bool holds_rows = lanes_of<D> == 4 || lanes_of<D> == 8;

#if HWY_TARGET != HWY_SCALAR  // which has no shuffles

/// Four rows in each half of the lanes (8 lanes: rows k and k + 4 side by side) to components, or
/// back: the same shuffles do both.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Quad<V> transpose(D d, const Quad<V>& rows) {
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    const V ab_even = hn::InterleaveLower(d, rows.a, rows.b);  // a0 b0 | a2 b2
    const V ab_odd = hn::InterleaveUpper(d, rows.a, rows.b);   // a1 b1 | a3 b3
    const V cd_even = hn::InterleaveLower(d, rows.c, rows.d);
    const V cd_odd = hn::InterleaveUpper(d, rows.c, rows.d);
    return {hn::OddEvenBlocks(hn::SwapAdjacentBlocks(cd_even), ab_even),
            hn::OddEvenBlocks(hn::SwapAdjacentBlocks(cd_odd), ab_odd),
            hn::OddEvenBlocks(cd_even, hn::SwapAdjacentBlocks(ab_even)),
            hn::OddEvenBlocks(cd_odd, hn::SwapAdjacentBlocks(ab_odd))};
  } else {
    const hn::RepartitionToWide<D> wide;
    const auto ab_low = hn::BitCast(wide, hn::InterleaveLower(d, rows.a, rows.b));  // a0 b0 a1 b1
    const auto ab_high = hn::BitCast(wide, hn::InterleaveUpper(d, rows.a, rows.b));
    const auto cd_low = hn::BitCast(wide, hn::InterleaveLower(d, rows.c, rows.d));
    const auto cd_high = hn::BitCast(wide, hn::InterleaveUpper(d, rows.c, rows.d));
    return {hn::BitCast(d, hn::InterleaveLower(wide, ab_low, cd_low)),
            hn::BitCast(d, hn::InterleaveUpper(wide, ab_low, cd_low)),
            hn::BitCast(d, hn::InterleaveLower(wide, ab_high, cd_high)),
            hn::BitCast(d, hn::InterleaveUpper(wide, ab_high, cd_high))};
  }
}

/// Rows at the given addresses, side by side as `transpose` wants them.
template <class D, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE Quad<V> load_rows(D d, const T* const* row) {
  if constexpr (lanes_of<D> == 8) {
    const hn::Half<D> half;
    const auto two = [&](int k) {
      return hn::Combine(d, hn::LoadU(half, row[k + 4]), hn::LoadU(half, row[k]));
    };
    return {two(0), two(1), two(2), two(3)};
  } else {
    return {hn::LoadU(d, row[0]), hn::LoadU(d, row[1]), hn::LoadU(d, row[2]),
            hn::LoadU(d, row[3])};
  }
}

#endif

/// Components of sums of two rows: first[c] + second[c], with the sign of second[c] changed where
/// `flip` holds -0.0 (the same four numbers again and again, for as many lanes as there are).
template <class D, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE Quad<V> combine_rows(D d, const T* const* first, const T* const* second, const T* flip) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (holds_rows<D>) {
    const V sign = hn::Load(d, flip);
    const Quad<V> a = load_rows(d, first);
    const Quad<V> b = load_rows(d, second);
    return transpose(d, Quad<V>{hn::Add(a.a, hn::Xor(sign, b.a)), hn::Add(a.b, hn::Xor(sign, b.b)),
                                hn::Add(a.c, hn::Xor(sign, b.c)),
                                hn::Add(a.d, hn::Xor(sign, b.d))});
  }
#endif
  T sum[4][lanes_of<D>];
  for (int lane = 0; lane < lanes_of<D>; ++lane) {
    for (int c = 0; c < 4; ++c) {
      sum[c][lane] = std::signbit(flip[c]) ? first[lane][c] - second[lane][c]
                                           : first[lane][c] + second[lane][c];
    }
  }
  return {hn::LoadU(d, sum[0]), hn::LoadU(d, sum[1]), hn::LoadU(d, sum[2]), hn::LoadU(d, sum[3])};
}

/// Components of the rows at the given addresses.
template <class D, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE Quad<V> gather_rows(D d, const T* const* row) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (holds_rows<D>) return transpose(d, load_rows(d, row));
#endif
  T lanes[4][lanes_of<D>];
  for (int lane = 0; lane < lanes_of<D>; ++lane) {
    for (int c = 0; c < 4; ++c) lanes[c][lane] = row[lane][c];
  }
  return {hn::LoadU(d, lanes[0]), hn::LoadU(d, lanes[1]), hn::LoadU(d, lanes[2]),
          hn::LoadU(d, lanes[3])};
}

/// Components to rows: row[4 k ... 4 k + 2] of lane k; the fourth number of each row is 0.
template <class D, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE void store_rows(D d, V x, V y, V z, T* HWY_RESTRICT rows) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (holds_rows<D>) {
    const Quad<V> t = transpose(d, Quad<V>{x, y, z, hn::Zero(d)});
    if constexpr (lanes_of<D> == 8) {
      const hn::Half<D> half;
      const V* const vectors[4] = {&t.a, &t.b, &t.c, &t.d};
      for (int k = 0; k < 4; ++k) {
        hn::Store(hn::LowerHalf(half, *vectors[k]), half, rows + 4 * k);
        hn::Store(hn::UpperHalf(half, *vectors[k]), half, rows + 4 * (k + 4));
      }
    } else {
      hn::Store(t.a, d, rows);
      hn::Store(t.b, d, rows + 4);
      hn::Store(t.c, d, rows + 8);
      hn::Store(t.d, d, rows + 12);
    }
    return;
  }
#endif
  T lanes[3][lanes_of<D>];
  hn::StoreU(x, d, lanes[0]);
  hn::StoreU(y, d, lanes[1]);
  hn::StoreU(z, d, lanes[2]);
  for (int lane = 0; lane < lanes_of<D>; ++lane) {
    for (int c = 0; c < 3; ++c) rows[4 * lane + c] = lanes[c][lane];
    rows[4 * lane + 3] = 0;
  }
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
