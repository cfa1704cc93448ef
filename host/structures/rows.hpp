// rows.hpp -- four numbers of a leaf or prim in one register: three coordinates, and the bits of an integer behind them.
#pragma once
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "rt_plugin.h"

namespace clarity {

using Row = float __attribute__((vector_size(16)));
using RowBits = rt_u32 __attribute__((vector_size(16)));
static_assert(sizeof(rt_packed_prim) == 3 * sizeof(Row) && sizeof(rt_prim) == 2 * sizeof(Row), "rows of four numbers");

inline Row load_row(const float* p) {
    Row row;
    std::memcpy(&row, p, sizeof row);
    return row;
}
inline void store_row(float* p, Row row) {
    std::memcpy(p, &row, sizeof row);
}
// A point whose fourth number is 0, with this integer behind it.
inline Row named(Row point, rt_u32 name) {
    return reinterpret_cast<Row>(reinterpret_cast<RowBits>(point) | RowBits{0, 0, 0, name});
}
// A point with the integer that is behind another one.
inline Row named_as(Row point, Row other) {
    constexpr RowBits kName = {0, 0, 0, ~0u};
    return reinterpret_cast<Row>((reinterpret_cast<RowBits>(point) & ~kName) | (reinterpret_cast<RowBits>(other) & kName));
}
// Comparisons with NaN are false: the second operand is taken.
#ifdef __SSE2__
inline Row least(Row a, Row b) {
    return _mm_min_ps(a, b);
}
inline Row most(Row a, Row b) {
    return _mm_max_ps(a, b);
}
#else
inline Row least(Row a, Row b) {
    return a < b ? a : b;
}
inline Row most(Row a, Row b) {
    return a > b ? a : b;
}
#endif

}  // namespace clarity
