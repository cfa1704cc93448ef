#include "clarity_bvh/build/spatial_bins.hpp"

namespace clarity::bvh {
namespace {

bool can_be_cut(const Record& record) {
    return RT_REF_KIND(record.ref()) == RT_REF_TRIANGLE;
}

}  // namespace

Bounds bounds_of(const Record& record) {
    Bounds box;
    store(box.lo, xyz(load(record.lo)));
    store(box.neg_hi, load(record.neg_hi));
    return box;
}

Planes::Planes(const Bounds& box) {
    for (int a = 0; a < 3; ++a) {
        base_[a] = box.lo[a];
        step_[a] = box.hi(a) / kSpatialBins - box.lo[a] / kSpatialBins;
        scale_[a] = step_[a] > 1.0f / FLT_MAX ? 1.0f / step_[a] : 0.0f;  // a flat box lies in slice 0 whole
    }
}

uint32_t Planes::slice(int axis, float x) const {
    const float at = (x - base_[axis]) * scale_[axis];
    return at > 0.0f ? static_cast<uint32_t>(std::min(at, float{kSpatialBins - 1})) : 0;
}

float Planes::plane(int axis, uint32_t slice) const {
    return base_[axis] + static_cast<float>(slice) * step_[axis];
}

SliceRange extent(const Planes& planes, int axis, const Record& record) {
    if (!can_be_cut(record)) {
        const uint32_t only = planes.slice(axis, 0.5f * record.lo[axis] - 0.5f * record.neg_hi[axis]);
        return {only, only};
    }
    return {planes.slice(axis, record.lo[axis]), planes.slice(axis, -record.neg_hi[axis])};
}

Bounds clip(const rt_packed_prim& triangle, const Bounds& part, int axis, float from, float to) {
    const float* const corner[3] = {triangle.a, triangle.b, triangle.c};
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    const auto grow = [&](int a, float least, float most) {
        lo[a] = std::min(lo[a], least);
        hi[a] = std::max(hi[a], most);
    };
    for (int i = 0; i < 3; ++i) {
        const float *p = corner[i], *q = corner[(i + 1) % 3];
        if (p[axis] >= from && p[axis] <= to)
            for (int a = 0; a < 3; ++a) grow(a, p[a], p[a]);
        for (const float plane : {from, to}) {
            if (!((p[axis] < plane && q[axis] > plane) || (p[axis] > plane && q[axis] < plane))) continue;
            const double t = (double{plane} - p[axis]) / (double{q[axis]} - p[axis]);
            for (int a = 0; a < 3; ++a) {
                const auto x = static_cast<float>(p[a] + t * (double{q[a]} - p[a]));
                const float room = 1.2e-7f * std::fabs(x) + FLT_MIN;  // more than half an ulp
                grow(a, a == axis ? plane : x - room, a == axis ? plane : x + room);
            }
        }
    }
    Bounds box = part;
    for (int a = 0; a < 3; ++a) {
        const float least = std::max(part.lo[a], lo[a]), most = std::min(part.hi(a), hi[a]);
        if (!(least <= most)) continue;  // only rounding touches this slab: keep the bounds of `part`
        box.lo[a] = least;
        box.neg_hi[a] = -most;
    }
    // The planes limit every part.
    const float least = std::max(part.lo[axis], std::min(from, part.hi(axis))),
                most = std::min(part.hi(axis), std::max(to, part.lo[axis]));
    box.lo[axis] = std::min(std::max(box.lo[axis], least), most);
    box.neg_hi[axis] = -std::max(std::min(box.hi(axis), most), box.lo[axis]);
    return box;
}

void SpatialBins::add(const Record* first, const Record* end, const Planes& planes, const rt_geometry& geometry) {
    for (const Record* r = first; r != end; ++r) {
        const Bounds whole = bounds_of(*r);
        for (int axis = 0; axis < 3; ++axis) {
            const SliceRange in = extent(planes, axis, *r);
            ++enter[in.first][axis];
            ++leave[in.last][axis];
            if (in.first == in.last) {
                box[in.first][axis].add(whole);
                continue;
            }
            const rt_packed_prim& triangle = geometry.triangles[RT_REF_INDEX(r->ref())];
            for (uint32_t b = in.first; b <= in.last; ++b)
                box[b][axis].add(clip(triangle, whole, axis, b == in.first ? -FLT_MAX : planes.plane(axis, b),
                                      b == in.last ? FLT_MAX : planes.plane(axis, b + 1)));
        }
    }
}

void SpatialBins::add(const SpatialBins& other) {
    for (uint32_t b = 0; b < kSpatialBins; ++b)
        for (int axis = 0; axis < 3; ++axis) {
            box[b][axis].add(other.box[b][axis]);
            enter[b][axis] += other.enter[b][axis];
            leave[b][axis] += other.leave[b][axis];
        }
}

SpatialSplit find_spatial_split(const SpatialBins& bins, const AreaScale& area) {
    SpatialSplit best;
    for (int axis = 0; axis < 3; ++axis) {
        Bounds right_box[kSpatialBins];
        uint32_t right_count[kSpatialBins], count = 0;
        Bounds box;
        for (uint32_t b = kSpatialBins - 1; b > 0; --b) {
            box.add(bins.box[b][axis]);
            count += bins.leave[b][axis];
            right_box[b] = box;
            right_count[b] = count;
        }
        box = Bounds{};
        count = 0;
        for (uint32_t b = 1; b < kSpatialBins; ++b) {
            box.add(bins.box[b - 1][axis]);
            count += bins.enter[b - 1][axis];
            if (count == 0 || right_count[b] == 0) continue;
            const float cost = area.half_area(box) * static_cast<float>(count) +
                               area.half_area(right_box[b]) * static_cast<float>(right_count[b]);
            if (cost < best.cost) best = {cost, axis, b, count, right_count[b], box, right_box[b]};
        }
    }
    return best;
}

}  // namespace clarity::bvh
