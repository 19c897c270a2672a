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

/// (Number by number: a copy of the whole would go through memory by halves.)
template <class V>
HWY_INLINE void assign(const Quad<V>& from, Quad<V>& to) {
  to.a = from.a;
  to.b = from.b;
  to.c = from.c;
  to.d = from.d;
}

template <class D>
inline constexpr int lanes_of = static_cast<int>(hn::MaxLanes(D()));

/// True where the registers hold whole rows of four numbers: one, two or four of them.
template <class D>
inline constexpr bool holds_rows = lanes_of<D> == 4 || lanes_of<D> == 8 || lanes_of<D> == 16;

/// The same of rows of eight numbers.
template <class D>
inline constexpr bool holds_long_rows = lanes_of<D> == 8 || lanes_of<D> == 16;

// ---- one row ----

#if HWY_MAX_BYTES >= 32
template <class T>
using Row = hn::Vec<hn::FixedTag<T, 4>>;

template <class T>
HWY_INLINE Row<T> load_row(const T* row) {
  return hn::Load(hn::FixedTag<T, 4>(), row);
}
/// Three of four numbers, and 0. (A masked load would do, but takes 4 ns.)
template <class T>
HWY_INLINE Row<T> load_vector(const T* numbers) {
  const hn::FixedTag<T, 4> d;
  const hn::RebindToUnsigned<decltype(d)> bits;
  using Bits = hn::TFromD<decltype(bits)>;
  alignas(32) static constexpr Bits three[4] = {~Bits{0}, ~Bits{0}, ~Bits{0}, 0};
  return hn::And(hn::LoadU(d, numbers), hn::BitCast(d, hn::Load(bits, three)));
}
template <class T>
HWY_INLINE void store_row(Row<T> value, T* row) {
  hn::Store(value, hn::FixedTag<T, 4>(), row);
}
template <class T>
HWY_INLINE Row<T> same_row(T value) {
  return hn::Set(hn::FixedTag<T, 4>(), value);
}
/// a b + c
template <class V>
HWY_INLINE V multiply_add(V a, V b, V c) {
  return hn::MulAdd(a, b, c);
}
template <class V>
HWY_INLINE V subtract(V a, V b) {
  return hn::Sub(a, b);
}
template <class T>
HWY_INLINE Row<double> widened(Row<T> row) {
  if constexpr (sizeof(T) == sizeof(double)) {
    return row;
  } else {
    return hn::PromoteTo(hn::FixedTag<double, 4>(), row);
  }
}
HWY_INLINE double square_norm(Row<double> row) {
  const hn::FixedTag<double, 4> d;
  return hn::GetLane(hn::SumOfLanes(d, hn::Mul(row, row)));
}
#else  // registers are narrower than a row
template <class T>
struct Row {
  T value[4];
};
template <class T>
HWY_INLINE Row<T> load_row(const T* row) {
  return {{row[0], row[1], row[2], row[3]}};
}
template <class T>
HWY_INLINE Row<T> load_vector(const T* numbers) {
  return {{numbers[0], numbers[1], numbers[2], 0}};
}
template <class T>
HWY_INLINE void store_row(Row<T> value, T* row) {
  for (int c = 0; c < 4; ++c) row[c] = value.value[c];
}
template <class T>
HWY_INLINE Row<T> same_row(T value) {
  return {{value, value, value, value}};
}
template <class T>
HWY_INLINE Row<T> multiply_add(const Row<T>& a, const Row<T>& b, const Row<T>& c) {
  Row<T> sum = c;
  for (int k = 0; k < 4; ++k) sum.value[k] += a.value[k] * b.value[k];
  return sum;
}
template <class T>
HWY_INLINE Row<T> subtract(const Row<T>& a, const Row<T>& b) {
  Row<T> difference = a;
  for (int k = 0; k < 4; ++k) difference.value[k] -= b.value[k];
  return difference;
}
template <class T>
HWY_INLINE Row<double> widened(const Row<T>& row) {
  Row<double> wide{};
  for (int c = 0; c < 4; ++c) wide.value[c] = static_cast<double>(row.value[c]);
  return wide;
}
HWY_INLINE double square_norm(const Row<double>& row) {
  double sum = 0;
  for (const double number : row.value) sum += number * number;
  return sum;
}
#endif

// ---- one row a lane ----

#if HWY_MAX_BYTES >= 32

/// Four rows in each four of the lanes (8 lanes: rows k and k + 4 side by side; 16: k, k + 4, k + 8
/// and k + 12) to components, or back: the same shuffles do both.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Quad<V> transpose(D d, const Quad<V>& rows) {
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    const V ab_even = hn::InterleaveLower(d, rows.a, rows.b);  // a0 b0 | a2 b2
    const V ab_odd = hn::InterleaveUpper(d, rows.a, rows.b);   // a1 b1 | a3 b3
    const V cd_even = hn::InterleaveLower(d, rows.c, rows.d);
    const V cd_odd = hn::InterleaveUpper(d, rows.c, rows.d);
    if constexpr (lanes_of<D> == 4) {
      return {hn::ConcatLowerLower(d, cd_even, ab_even), hn::ConcatLowerLower(d, cd_odd, ab_odd),
              hn::ConcatUpperUpper(d, cd_even, ab_even), hn::ConcatUpperUpper(d, cd_odd, ab_odd)};
    } else {
      return {hn::OddEvenBlocks(hn::SwapAdjacentBlocks(cd_even), ab_even),
              hn::OddEvenBlocks(hn::SwapAdjacentBlocks(cd_odd), ab_odd),
              hn::OddEvenBlocks(cd_even, hn::SwapAdjacentBlocks(ab_even)),
              hn::OddEvenBlocks(cd_odd, hn::SwapAdjacentBlocks(ab_odd))};
    }
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

/// The rows of so many `numbers` of the lanes k, k + numbers and so on, side by side.
template <int numbers, class D, class RowOf>
HWY_INLINE hn::Vec<D> load_side_by_side(D d, const RowOf& row, int k) {
  if constexpr (lanes_of<D> == numbers) {
    return hn::LoadU(d, row(k));
  } else {
    const hn::Half<D> half;
    const auto upper = load_side_by_side<numbers>(half, row, k + lanes_of<D> / 2);
    return hn::Combine(d, upper, load_side_by_side<numbers>(half, row, k));
  }
}

/// Rows at the addresses row(lane), side by side as `transpose` wants them. (Not an array of
/// addresses: the compiler would go through memory.)
template <class D, class RowOf, class V = hn::Vec<D>>
HWY_INLINE Quad<V> load_rows(D d, const RowOf& row) {
  return {load_side_by_side<4>(d, row, 0), load_side_by_side<4>(d, row, 1),
          load_side_by_side<4>(d, row, 2), load_side_by_side<4>(d, row, 3)};
}

/// The first `count` lanes of the rows of the lanes k, k + 4 and so on, to their addresses.
template <class D, class RowOf>
HWY_INLINE void store_side_by_side(D d, hn::Vec<D> rows, int k, int count, const RowOf& row) {
  if constexpr (lanes_of<D> == 4) {
    if (k < count) hn::Store(rows, d, row(k));
  } else {
    const hn::Half<D> half;
    store_side_by_side(half, hn::LowerHalf(half, rows), k, count, row);
    store_side_by_side(half, hn::UpperHalf(half, rows), k + lanes_of<D> / 2, count, row);
  }
}

#endif

/// Components of sums of two rows: first[c] + second[c], with the sign of second[c] changed where
/// `flip` holds -0.0 (the same four numbers again and again, for as many lanes as there are).
template <class D, class First, class Second, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE Quad<V> combine_rows(D d, const First& first, const Second& second, const T* flip) {
#if HWY_MAX_BYTES >= 32
  if constexpr (holds_rows<D>) {
    const V sign = hn::Load(d, flip);
    const Quad<V> a = load_rows(d, first);
    const Quad<V> b = load_rows(d, second);
    return transpose(d,
                     Quad<V>{hn::Add(a.a, hn::Xor(sign, b.a)), hn::Add(a.b, hn::Xor(sign, b.b)),
                             hn::Add(a.c, hn::Xor(sign, b.c)), hn::Add(a.d, hn::Xor(sign, b.d))});
  }
#endif
  T sum[4][lanes_of<D>];
  for (int lane = 0; lane < lanes_of<D>; ++lane) {
    for (int c = 0; c < 4; ++c) {
      sum[c][lane] = std::signbit(flip[c]) ? first(lane)[c] - second(lane)[c]
                                           : first(lane)[c] + second(lane)[c];
    }
  }
  return {hn::LoadU(d, sum[0]), hn::LoadU(d, sum[1]), hn::LoadU(d, sum[2]), hn::LoadU(d, sum[3])};
}

/// Eight vectors: of rows of eight numbers while they are read, of components afterwards.
template <class V>
struct Eight {
  Quad<V> low, high;
};

#if HWY_MAX_BYTES >= 32

/// Eight rows of eight numbers in each eight of the lanes (16 lanes: rows k and k + 8 side by side)
/// to components, or back.
template <class D, class V = hn::Vec<D>>
HWY_INLINE Eight<V> transpose(D d, const Eight<V>& rows) {
  const Quad<V>& p = rows.low;
  const Quad<V>& q = rows.high;
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    // Pairs of rows to pairs of numbers, then blocks of two numbers as a matrix of 4 x 4.
    const auto blocks = [d](V r0, V r1, V r2, V r3) HWY_ATTR {
      const V low02 = hn::ConcatLowerLower(d, r2, r0);
      const V low13 = hn::ConcatLowerLower(d, r3, r1);
      const V high02 = hn::ConcatUpperUpper(d, r2, r0);
      const V high13 = hn::ConcatUpperUpper(d, r3, r1);
      return Quad<V>{hn::OddEvenBlocks(hn::SwapAdjacentBlocks(low13), low02),
                     hn::OddEvenBlocks(low13, hn::SwapAdjacentBlocks(low02)),
                     hn::OddEvenBlocks(hn::SwapAdjacentBlocks(high13), high02),
                     hn::OddEvenBlocks(high13, hn::SwapAdjacentBlocks(high02))};
    };
    const auto even = blocks(hn::InterleaveLower(d, p.a, p.b), hn::InterleaveLower(d, p.c, p.d),
                             hn::InterleaveLower(d, q.a, q.b), hn::InterleaveLower(d, q.c, q.d));
    const auto odd = blocks(hn::InterleaveUpper(d, p.a, p.b), hn::InterleaveUpper(d, p.c, p.d),
                            hn::InterleaveUpper(d, q.a, q.b), hn::InterleaveUpper(d, q.c, q.d));
    return {{even.a, odd.a, even.b, odd.b}, {even.c, odd.c, even.d, odd.d}};
  } else {
    const Quad<V> first = transpose(d, p);   // components 0 to 3 | 4 to 7 of rows 0 to 3
    const Quad<V> second = transpose(d, q);  // of rows 4 to 7
    const auto low = [d](V from, V then) HWY_ATTR {
      if constexpr (lanes_of<D> == 8) {
        return hn::ConcatLowerLower(d, then, from);
      } else {
        return hn::OddEvenBlocks(hn::SwapAdjacentBlocks(then), from);
      }
    };
    const auto high = [d](V from, V then) HWY_ATTR {
      if constexpr (lanes_of<D> == 8) {
        return hn::ConcatUpperUpper(d, then, from);
      } else {
        return hn::OddEvenBlocks(then, hn::SwapAdjacentBlocks(from));
      }
    };
    return {{low(first.a, second.a), low(first.b, second.b), low(first.c, second.c),
             low(first.d, second.d)},
            {high(first.a, second.a), high(first.b, second.b), high(first.c, second.c),
             high(first.d, second.d)}};
  }
}

#endif

/// The same of rows of eight numbers, for eight signs.
template <class D, class First, class Second, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE Eight<V> combine_long_rows(D d, const First& first, const Second& second,
                                      const T* flip) {
#if HWY_MAX_BYTES >= 32
  if constexpr (holds_long_rows<D>) {
    const V sign = hn::Load(d, flip);
    const auto sum = [&](int k) HWY_ATTR {
      return hn::Add(load_side_by_side<8>(d, first, k),
                     hn::Xor(sign, load_side_by_side<8>(d, second, k)));
    };
    return transpose(d,
                     Eight<V>{{sum(0), sum(1), sum(2), sum(3)}, {sum(4), sum(5), sum(6), sum(7)}});
  }
#endif
  const auto first_rest = [&](int k) { return first(k) + 4; };
  const auto second_rest = [&](int k) { return second(k) + 4; };
  return {combine_rows(d, first, second, flip), combine_rows(d, first_rest, second_rest, flip + 4)};
}

/// Components of the rows at the addresses row(lane).
template <class D, class RowOf, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE Quad<V> gather_rows(D d, const RowOf& row) {
#if HWY_MAX_BYTES >= 32
  if constexpr (holds_rows<D>) return transpose(d, load_rows(d, row));
#endif
  T lanes[4][lanes_of<D>];
  for (int lane = 0; lane < lanes_of<D>; ++lane) {
    for (int c = 0; c < 4; ++c) lanes[c][lane] = row(lane)[c];
  }
  return {hn::LoadU(d, lanes[0]), hn::LoadU(d, lanes[1]), hn::LoadU(d, lanes[2]),
          hn::LoadU(d, lanes[3])};
}

/// Components to the rows at the addresses row(lane), of the first `count` lanes only.
template <class D, class RowOf, class T = hn::TFromD<D>, class V = hn::Vec<D>>
HWY_INLINE void scatter_rows(D d, const Quad<V>& components, int count, const RowOf& row) {
#if HWY_MAX_BYTES >= 32
  if constexpr (holds_rows<D>) {
    const Quad<V> t = transpose(d, components);
    store_side_by_side(d, t.a, 0, count, row);
    store_side_by_side(d, t.b, 1, count, row);
    store_side_by_side(d, t.c, 2, count, row);
    store_side_by_side(d, t.d, 3, count, row);
    return;
  }
#endif
  T lanes[4][lanes_of<D>];
  hn::StoreU(components.a, d, lanes[0]);
  hn::StoreU(components.b, d, lanes[1]);
  hn::StoreU(components.c, d, lanes[2]);
  hn::StoreU(components.d, d, lanes[3]);
  for (int lane = 0; lane < count; ++lane) {
    for (int c = 0; c < 4; ++c) row(lane)[c] = lanes[c][lane];
  }
}

/// sum += row, or −= if `mirrored`.
template <bool mirrored, class T>
HWY_INLINE void add_row(const T* HWY_RESTRICT row, T* HWY_RESTRICT sum) {
#if HWY_MAX_BYTES >= 32
  const hn::FixedTag<T, 4> d;
  const auto before = hn::Load(d, sum);
  const auto value = hn::Load(d, row);
  hn::Store(mirrored ? hn::Sub(before, value) : hn::Add(before, value), d, sum);
#else
  for (int c = 0; c < 4; ++c) sum[c] += mirrored ? -row[c] : row[c];
#endif
}

}  // namespace fluxpact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
