#include "render/emitters/pick_table.hpp"

#include <algorithm>
#include <cmath>

namespace clarity {

std::vector<rt_u32> deal(const std::vector<double>& weights, rt_u32 total) {
    std::vector<rt_u32> shares(weights.size(), 0);
    double sum = 0;
    rt_u32 takers = 0;
    for (const double weight : weights)
        if (weight > 0) sum += weight, ++takers;
    if (takers == 0) return shares;
    // One for each; the rest by rounding the running sum, so that the total is exact.
    const double rest = double(total) - takers;
    double so_far = 0;
    rt_u32 dealt = 0, seen = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] > 0)) continue;
        so_far += weights[i];
        const auto until = ++seen == takers
                               ? static_cast<rt_u32>(rest)
                               : std::min(static_cast<rt_u32>(std::llround(so_far / sum * rest)), static_cast<rt_u32>(rest));
        shares[i] = 1 + until - dealt;
        dealt = until;
    }
    return shares;
}

unsigned fill_pick_table(const std::vector<double>& weights, std::vector<rt_emitter>& emitters) {
    const std::vector<rt_u32> shares = deal(weights, RT_PICKS);
    unsigned bits = 0;
    while ((size_t(1) << bits) < weights.size()) ++bits;
    const rt_u32 cells = rt_u32(1) << bits, room = rt_u32(1) << (RT_PICK_BITS - bits);
    emitters.resize(cells);
    std::vector<rt_u32> left(cells, 0), small, large;
    for (rt_u32 i = 0; i < cells; ++i) {
        if (i < shares.size()) left[i] = shares[i];
        emitters[i].alias = i;
        emitters[i].threshold = room;
        emitters[i].pick = static_cast<rt_f32>(double(left[i]) / RT_PICKS);
        (left[i] < room ? small : large).push_back(i);
    }
    // A cell whose own emitter does not fill it gives the rest to an emitter that has too much (Vose 1991, "A Linear Algorithm
    // for Generating Random Numbers with a Given Distribution").
    while (!small.empty() && !large.empty()) {
        const rt_u32 poor = small.back(), rich = large.back();
        small.pop_back();
        emitters[poor].threshold = left[poor];
        emitters[poor].alias = rich;
        left[rich] -= room - left[poor];
        if (left[rich] >= room) continue;
        large.pop_back();
        small.push_back(rich);
    }
    return bits;
}

}  // namespace clarity
