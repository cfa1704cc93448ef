#include "clarity_bvh/build/spatial.hpp"

#include <vector>

#include "clarity_bvh/build/spatial_bins.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

// Spatial splits are tried only if the children's boxes overlap by at least these fractions of the node's own and of the
// group's area.
// The first value keeps small triangles whole where cutting them would gain at one node and cost more below it. With 0.2
// instead, the whole of salle_de_bain costs 1 % more than without any cuts.
constexpr float kLeastOverlap = 0.5f, kLeastOverlapOfRoot = 1e-5f;
// Ranges of at most this many primitives that are not worth a spatial split are built by the kernels, which do better there.
constexpr uint32_t kFew = 8;
constexpr uint32_t kChunk = 8192;

// Calls add(chunk's records, chunk's sum) for all chunks on all cores, and returns the sums merged in chunk order.
template <class Sum, class Add, class Merge>
Sum over_chunks(const rt_host* host, const Record* first, const Record* end, const Sum& none, Add&& add, Merge&& merge) {
    const auto count = static_cast<uint32_t>(end - first), chunks = (count + kChunk - 1) / kChunk;
    Sum total = none;
    if (chunks <= 2) {
        add(first, end, total);
        return total;
    }
    std::vector<Sum> sums(chunks, none);
    rt::parallel_for(host, chunks,
                     [&](rt_u32 c) { add(first + size_t{c} * kChunk, first + std::min(count, (c + 1) * kChunk), sums[c]); });
    for (const Sum& sum : sums) merge(sum, total);
    return total;
}

Bounds common(const Bounds& a, const Bounds& b) {
    Bounds box;
    store(box.lo, max(load(a.lo), load(b.lo)));
    store(box.neg_hi, max(load(a.neg_hi), load(b.neg_hi)));
    return box;
}

Bounds both(const Bounds& a, const Bounds& b) {
    Bounds box = a;
    box.add(b);
    return box;
}

// Writes the records of one side of a split, and computes their bounds.
class Side {
 public:
    Side(Record* next, int step) : next_(next), step_(step) {}
    void take(const Record& from, const Bounds& box) {
        Record& to = *next_;
        store(to.lo, xyz(load(box.lo)));
        store(to.neg_hi, xyz(load(box.neg_hi)));
        to.set_ref(from.ref());
        next_ += step_;
        bound(&to, &to + 1, box_, centroids2_);
        ++count_;
    }
    void finish(Range& range) const {
        range.box = box_;
        range.centroids2 = centroids2_;
    }
    uint32_t count() const { return count_; }

 private:
    Record* next_;
    const int step_;
    uint32_t count_ = 0;
    Bounds box_, centroids2_;
};

// Distributes records over both sides of a spatial split. A triangle that crosses the plane is cut in two, or goes whole to one
// side where that is cheaper (section 4.4 of the paper).
class Cutter {
 public:
    Cutter(const SpatialSplit& split, const Planes& planes, const AreaScale& area, const rt_geometry& geometry)
        : split_(split),
          planes_(planes),
          area_(area),
          geometry_(geometry),
          left_area_(area.half_area(split.left)),
          right_area_(area.half_area(split.right)),
          left_count_(static_cast<float>(split.left_count)),
          right_count_(static_cast<float>(split.right_count)) {}

    void place(const Record& r, Side& left, Side& right) {
        const SliceRange in = extent(planes_, split_.axis, r);
        const Bounds whole = bounds_of(r);
        if (in.last < split_.bin) return left.take(r, whole);
        if (in.first >= split_.bin) return right.take(r, whole);
        const float cut = left_area_ * left_count_ + right_area_ * right_count_;
        const float to_left = area_.half_area(both(split_.left, whole)) * left_count_ + right_area_ * (right_count_ - 1);
        const float to_right = left_area_ * (left_count_ - 1) + area_.half_area(both(split_.right, whole)) * right_count_;
        // The box and counts of the sides then apply to all later records.
        if (to_left < cut && to_left <= to_right) {
            split_.left.add(whole);
            left_area_ = area_.half_area(split_.left);
            right_count_ -= 1;
            return left.take(r, whole);
        }
        if (to_right < cut) {
            split_.right.add(whole);
            right_area_ = area_.half_area(split_.right);
            left_count_ -= 1;
            return right.take(r, whole);
        }
        const rt_packed_prim& triangle = geometry_.triangles[RT_REF_INDEX(r.ref())];
        const float plane = planes_.plane(split_.axis, split_.bin);
        left.take(r, clip(triangle, whole, split_.axis, -FLT_MAX, plane));
        right.take(r, clip(triangle, whole, split_.axis, plane, FLT_MAX));
    }

 private:
    SpatialSplit split_;
    const Planes& planes_;
    const AreaScale& area_;
    const rt_geometry& geometry_;
    float left_area_, right_area_, left_count_, right_count_;
};

// Divides the unused room between both parts by their sizes. The parts lie at the two ends of the room.
void share_room(const RoomyRange& from, RoomyRange& left, RoomyRange& right) {
    const uint64_t count = uint64_t{left.range.count()} + right.range.count();
    const uint64_t spare = right.range.begin - left.range.end;
    left.room_begin = from.room_begin;
    left.room_end = right.room_begin = left.range.end + static_cast<uint32_t>(spare * left.range.count() / count);
    right.room_end = from.room_end;
}

}  // namespace

SpatialSplitter::SpatialSplitter(const rt_host* host, const Workspace& workspace, const rt_geometry& geometry,
                                 const Bounds& root)
    : host_(host), workspace_(workspace), geometry_(geometry), root_scale_(root), root_area_(root_scale_.half_area(root)) {}

// Finds the best plane between bins, if there is one.
void SpatialSplitter::find_object_split(const Range& range, const AreaScale& area, Split& split) const {
    if (!may_bin(workspace_.rules, range)) return;
    const Record* const records = workspace_.records[range.buffer];
    const uint32_t bin_count = bins_for(workspace_.rules, range.count());
    const Slices slices(range.centroids2, bin_count);
    const Kernels& k = kernels();
    Bins none;
    k.clear(none, bin_count);
    const Bins bins = over_chunks(
        host_, records + range.begin, records + range.end, none,
        [&](const Record* first, const Record* end, Bins& sum) { k.bin(first, end, slices, sum); },
        [&](const Bins& more, Bins& sum) { k.merge(more, bin_count, sum); });
    k.find_split(bins, bin_count, area, range.count(), split);
}

bool SpatialSplitter::cut(const RoomyRange& from, const AreaScale& area, const Split& object, RoomyRange& left,
                          RoomyRange& right) const {
    const Range& range = from.range;
    if (from.spare() == 0 || !(object.cost < INFINITY)) return false;
    const Bounds overlap = common(object.left, object.right);
    for (int a = 0; a < 3; ++a)
        if (overlap.lo[a] > overlap.hi(a)) return false;
    const float whole = area.half_area(range.box);
    if (area.half_area(overlap) < kLeastOverlap * whole || root_scale_.half_area(overlap) < kLeastOverlapOfRoot * root_area_)
        return false;

    const Record *const first = workspace_.records[range.buffer] + range.begin, *const end = workspace_.records[range.buffer] +
                                                                                             range.end;
    const Planes planes(range.box);
    const SpatialBins bins = over_chunks(
        host_, first, end, SpatialBins{},
        [&](const Record* a, const Record* b, SpatialBins& sum) { sum.add(a, b, planes, geometry_); },
        [](const SpatialBins& more, SpatialBins& sum) { sum.add(more); });
    const SpatialSplit split = find_spatial_split(bins, area);
    const Rules& rules = workspace_.rules;
    if (!(split.cost < object.cost) || split.left_count == range.count() || split.right_count == range.count() ||
        split.left_count + split.right_count - range.count() > from.spare())
        return false;
    if (range.count() <= rules.max_leaf && rules.traversal_cost * whole + rules.intersection_cost * split.cost >=
                                               rules.intersection_cost * static_cast<float>(range.count()) * whole)
        return false;  // a leaf is cheaper

    Record* const to = workspace_.records[range.buffer ^ 1];
    Side left_side(to + from.room_begin, 1), right_side(to + from.room_end - 1, -1);
    Cutter cutter(split, planes, area, geometry_);
    for (const Record* r = first; r != end; ++r) cutter.place(*r, left_side, right_side);
    if (left_side.count() == 0 || right_side.count() == 0) return false;
    left.range.begin = from.room_begin;
    left.range.end = left.range.begin + left_side.count();
    right.range.end = from.room_end;
    right.range.begin = right.range.end - right_side.count();
    left.range.buffer = right.range.buffer = range.buffer ^ 1;
    left.range.depth = right.range.depth = range.depth + 1;
    left_side.finish(left.range);
    right_side.finish(right.range);
    share_room(from, left, right);
    return true;
}

void SpatialSplitter::split(const RoomyRange& from, RoomyRange& left, RoomyRange& right) const {
    const Range& range = from.range;
    const AreaScale area(range.box);
    Split object;
    find_object_split(range, area, object);
    if (cut(from, area, object, left, right)) return;
    Record* const records = workspace_.records[range.buffer];
    if (!(object.cost < INFINITY)) {
        halve(records, range, left.range, right.range);
        left.room_begin = from.room_begin;
        left.room_end = right.room_begin = left.range.end;
        right.room_end = from.room_end;
        return;
    }
    begin_split(range, object, left.range, right.range);
    left.range.begin = from.room_begin;
    left.range.end = left.range.begin + object.left_count;
    right.range.end = from.room_end;
    right.range.begin = right.range.end - (range.count() - object.left_count);
    Record* const to = workspace_.records[range.buffer ^ 1];
    kernels().scatter(records + range.begin, records + range.end,
                      Slices(range.centroids2, bins_for(workspace_.rules, range.count())), object, to + left.range.begin,
                      to + right.range.begin, left.range.centroids2, right.range.centroids2);
    share_room(from, left, right);
}

// The next free positions of a tree that is being built, and its depth so far.
struct SpatialSplitter::Growth {
    uint32_t node, leaf, depth = 0;
};

Subtree SpatialSplitter::build(const RoomyRange& range, uint32_t& leaf_count) const {
    Growth growth{range.room_begin, range.room_begin};
    Subtree tree;
    tree.root = build_range(range, growth);
    tree.nodes = growth.node - range.room_begin;
    tree.depth = growth.depth;
    leaf_count = growth.leaf - range.room_begin;
    return tree;
}

uint32_t SpatialSplitter::build_range(const RoomyRange& from, Growth& growth) const {
    const uint32_t count = from.range.count();
    RoomyRange left, right;
    bool is_split = false;
    if (from.spare() > 0 && count > kFew) {
        split(from, left, right);
        is_split = true;
    } else if (from.spare() > 0 && count > 1 && depth_to_spare(workspace_.rules, from.range)) {
        const AreaScale area(from.range.box);
        Split object;
        find_object_split(from.range, area, object);
        is_split = cut(from, area, object, left, right);
    }
    if (!is_split) {
        const Subtree tree = kernels().build_subtree(workspace_, from.range, growth.node, growth.leaf);
        growth.node += tree.nodes;
        growth.leaf += count;
        growth.depth = std::max(growth.depth, tree.depth);
        return tree.root;
    }
    if (right_is_larger(AreaScale(from.range.box), left.range, right.range)) std::swap(left, right);
    const uint32_t at = growth.node++;
    set_child(workspace_.nodes[at], 0, left.range.box, 0);
    set_child(workspace_.nodes[at], 1, right.range.box, 0);
    workspace_.nodes[at].child0 = build_range(left, growth);
    workspace_.nodes[at].child1 = build_range(right, growth);
    return at;
}

}  // namespace clarity::bvh
