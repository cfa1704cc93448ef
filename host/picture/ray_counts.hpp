// ray_counts.hpp -- what kernels count while they trace samples.
#pragma once
#include <cstdint>

#include "base/members.hpp"

namespace clarity {

struct RayCounts {
    uint64_t primary = 0, shadow = 0, secondary = 0, dropped = 0;  // rays; all but primary are 0 unless counted
    uint64_t not_finite = 0;  // samples of `path` that are no number or infinite, unless not counted
    uint64_t overflowed = 0;  // traversal stacks that were full (debug programs only)
    CLARITY_MEMBERS(primary, shadow, secondary, dropped, not_finite, overflowed);
    RayCounts& operator+=(const RayCounts& more) {
        std::apply([&](auto&... sum) { std::apply([&](auto&... one) { ((sum += one), ...); }, members_of(more)); },
                   members_of(*this));
        return *this;
    }
};

}  // namespace clarity
