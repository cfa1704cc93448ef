// pick_table.hpp -- a table by which a random number picks one of many things in proportion to their weights.
#pragma once
#include <cstddef>
#include <vector>

#include "rt_types.h"

namespace clarity {

// The most things that a table can pick from: each with a weight has one of the RT_PICKS numbers at least.
constexpr size_t kMostPicked = RT_PICKS / 2;

// Deals `total` numbers out in proportion to weights. Each thing with a weight gets one at least; there must be no more of
// these than numbers. If all weights are 0, none gets any.
std::vector<rt_u32> deal(const std::vector<double>& weights, rt_u32 total);

// Fills in threshold, alias and pick of the first weights.size() emitters, and appends cells until there are 2^bits, which it
// returns. See rt_emitter.
unsigned fill_pick_table(const std::vector<double>& weights, std::vector<rt_emitter>& emitters);

}  // namespace clarity
