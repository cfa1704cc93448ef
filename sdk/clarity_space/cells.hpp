// cells.hpp -- the cells of a regular grid, and which of them a primitive meets. Header only, part of the SDK.
//
// Head is a grid as kernels know it, for cl/lanes/cells.h: box[6] with the lower corner first, size[3] of a cell, and their
// numbers cells[3] along x, y and z. Cell (x, y, z) is number (z * cells[1] + y) * cells[0] + x.
#pragma once
#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>
#include <vector>

#include "clarity_space/primitives.hpp"
#include "rt_cost.hpp"

namespace clarity::space {

// The primitives of a group. Without triangles only their boxes are known.
struct Prims {
    const rt_prim* prims;
    const rt_packed_prim* triangles;
};

template <class Head>
size_t cell_count(const Head& head) {
    return size_t{head.cells[0]} * head.cells[1] * head.cells[2];
}

// How far the planes and divisions of kernels may be off, and the parts of cells here: they round by 6 and 8 * 2^-24 of the
// largest coordinate in all.
template <class Head>
double cell_slack(const Head& head, int axis) {
    return 24 * kEps * std::max(std::fabs(head.box[axis]), std::fabs(head.box[axis + 3])) + 1e-30;
}

// Parts the box into cells, about `wanted` in all and as cubic as can be. An axis along which the box is thinner than a cell
// has one, and the others share the cells.
template <class Head>
void shape_cells(Head& head, const double lo[3], const double hi[3], double wanted) {
    double extent[3];
    for (int k = 0; k < 3; ++k) head.box[k] = float(lo[k]), head.box[k + 3] = float(hi[k]);
    for (int k = 0; k < 3; ++k) {
        const double slack = cell_slack(head, k);
        head.box[k] = float(lo[k] - 2 * slack);
        head.box[k + 3] = float(hi[k] + 2 * slack);
        extent[k] = double{head.box[k + 3]} - head.box[k];
    }
    bool thin[3] = {false, false, false};
    for (int round = 0; round < 3; ++round) {
        double volume = 1, axes = 0;
        for (int k = 0; k < 3; ++k)
            if (!thin[k]) volume *= extent[k], ++axes;
        const double a_unit = axes > 0 ? std::pow(wanted / volume, 1 / axes) : 0;
        for (int k = 0; k < 3; ++k) {
            const double most = std::min(4096.0, extent[k] / (12 * cell_slack(head, k)));  // a part of a cell is 9 * 2^-24
            head.cells[k] = thin[k] ? 1 : rt_u32(std::clamp(extent[k] * a_unit, 1.0, std::max(most, 1.0)));
            thin[k] = thin[k] || extent[k] * a_unit < 1;
        }
    }
    for (int k = 0; k < 3; ++k) head.size[k] = float(extent[k] / head.cells[k]);
}

// The box of a cell, as kernels compute its planes.
template <class Head>
void cell_box(const Head& head, size_t cell, float lo[3], float hi[3]) {
    const size_t at[3] = {cell % head.cells[0], cell / head.cells[0] % head.cells[1], cell / head.cells[0] / head.cells[1]};
    for (int k = 0; k < 3; ++k) {
        lo[k] = std::fma(float(at[k]), head.size[k], head.box[k]);
        hi[k] = at[k] + 1 == head.cells[k] ? head.box[k + 3] : std::fma(float(at[k] + 1), head.size[k], head.box[k]);
    }
}

// Adds the cells of a grid, without primitives. whole: the surface of the box around all primitives. Returns that of a cell.
template <class Head>
double add_cells(const Head& head, double whole, rt::Surfaces& sums) {
    const float origin[3] = {0, 0, 0};
    const double cell = std::min(rt::surface_of(origin, head.size), whole);
    sums.add_node(cell * double(cell_count(head)));
    return cell;
}

// The same with their primitives: those of cell c are starts[c] to starts[c + 1] - 1 of a list. The last list is of primitives
// that are huge: every ray tests them.
template <class Head>
void add_cells(const Head& head, const rt_u32* starts, double whole, rt::Surfaces& sums) {
    const double cell = add_cells(head, whole, sums);
    const size_t cells = cell_count(head);
    sums.add_leaf(cell, double(starts[cells]) - starts[0]);
    sums.add_leaf(whole, double(starts[cells + 1]) - starts[cells]);
}

// The cells that a primitive's box meets, along each axis.
struct CellRange {
    int lo[3], hi[3];
};

// A primitive's box in parts of cells along each axis. The fourth numbers mean nothing.
struct PartRange {
    int lo[4], hi[4];

    CellRange cells() const {
        CellRange range;
        for (int k = 0; k < 3; ++k) range.lo[k] = int(rt_u32(lo[k]) / kParts), range.hi[k] = int(rt_u32(hi[k]) / kParts);
        return range;
    }
    // The parts in a cell along one axis: the first and the last, five bits each.
    rt_u32 within(int axis, int cell) const {
        const rt_u32 first = rt_u32(std::max(lo[axis] - kParts * cell, 0)),
                     last = rt_u32(std::min(hi[axis] - kParts * cell, kParts - 1));
        return (first | last << 5) << (10 * axis);
    }

    static constexpr int kParts = 32;                 // of a cell: RT_PARTS of cl/lanes/cell_parts.h
    static constexpr rt_u32 kAllOfCell = 0x3E0F83E0;  // all parts along each axis
};

// Finds the cells of primitives. What does not depend on the primitive is computed once.
template <class Head>
class CellFinder {
 public:
    explicit CellFinder(const Head& head) : head_(head), cells_(cell_count(head)) {
        for (int k = 0; k < 3; ++k) {
            const double slack = cell_slack(head, k);
            below_[k] = float(head.box[k] + slack), above_[k] = float(head.box[k] - slack);
            a_part_[k] = float(PartRange::kParts / double{head.size[k]});
            last_[k] = float(PartRange::kParts * head.cells[k] - 1), half_[k] = 0.5 * head.size[k] + slack;
        }
        const size_t row = head.cells[0], layer = row * head.cells[1];
        for (unsigned shape = 0; shape < 8; ++shape) {
            unsigned& count = counts_[shape];
            for (unsigned c = 0; c < 8; ++c)
                if ((c & ~shape) == 0 && count < 4) {
                    corners_[shape][count] = c;
                    near_[shape][count++] = (c & 1) + (c >> 1 & 1) * row + (c >> 2) * layer;
                }
        }
    }
    size_t cells() const { return cells_; }

    // In single precision and four at once, because a build spends its time here.
    PartRange parts(const rt_prim& p) const {
        const float lo[4] = {p.lo[0], p.lo[1], p.lo[2], 0}, hi[4] = {p.hi[0], p.hi[1], p.hi[2], 0};
        PartRange range;
        for (int k = 0; k < 4; ++k) range.lo[k] = int(std::min(std::max((lo[k] - below_[k]) * a_part_[k], 0.0f), last_[k]));
        for (int k = 0; k < 4; ++k) range.hi[k] = int(std::min(std::max((hi[k] - above_[k]) * a_part_[k], 0.0f), last_[k]));
        return range;
    }
    CellRange range(const rt_prim& p) const { return parts(p).cells(); }

    // Calls body(cell, meets, parts) for cells near primitive i: their numbers, whether the primitive meets them, and which
    // parts of each its box meets (PartRange::within() of all axes). Huge ones are in a cell of their own behind all others.
    // `meets` is no branch here, because a processor cannot predict it, nor how many cells a small primitive is near. Up to
    // four are in a table, and their planes are not asked, since they would hardly save a cell.
    template <class Body>
    void each(const Prims& of, rt_u32 i, const Body& body) const {
        const rt_prim& p = of.prims[i];
        if (is_huge(p)) return body(cells_, true, PartRange::kAllOfCell);
        const PartRange parts = this->parts(p);
        const CellRange r = parts.cells();
        const int x = r.hi[0] - r.lo[0], y = r.hi[1] - r.lo[1], z = r.hi[2] - r.lo[2];
        if ((x | y | z) <= 1 && (x & y & z) == 0) {
            const unsigned shape = unsigned(x | y << 1 | z << 2);
            const size_t first = (size_t(r.lo[2]) * head_.cells[1] + size_t(r.lo[1])) * head_.cells[0] + size_t(r.lo[0]);
            rt_u32 within[3][2];
            for (int k = 0; k < 3; ++k) {
                within[k][0] = parts.within(k, r.lo[k]);
                within[k][1] = parts.within(k, r.hi[k]);
            }
            for (unsigned c = 0; c < 4; ++c) {
                const unsigned corner = corners_[shape][c];
                body(first + near_[shape][c], c < counts_[shape],
                     within[0][corner & 1] | within[1][corner >> 1 & 1] | within[2][corner >> 2]);
            }
            return;
        }
        if (!of.triangles || RT_REF_KIND(p.ref) != RT_REF_TRIANGLE)
            return each_of(parts, [](int, int) { return Row{0, 0, 0}; }, body);
        const TrianglePlane plane(of.triangles[RT_REF_INDEX(p.ref)]);
        const double reach = plane.reach(half_), step = plane.normal(0) * double{head_.size[0]};
        each_of(
            parts,
            [&](int y, int z) {
                const int at[3] = {r.lo[0], y, z};
                double center[3];
                for (int k = 0; k < 3; ++k) center[k] = head_.box[k] + (at[k] + 0.5) * double{head_.size[k]};
                return Row{plane.height(center), step, reach};
            },
            body);
    }

 private:
    const Head& head_;
    size_t cells_;
    float below_[4] = {}, above_[4] = {}, a_part_[4] = {}, last_[4] = {};
    double half_[3];
    // The cells of one or two along each axis, from the first on: how many, and how much greater their numbers are. Bit k of
    // the index: two along axis k; of a corner: the second one.
    size_t near_[8][4] = {};
    unsigned counts_[8] = {}, corners_[8][4] = {};

    // Of the cells with one y and one z: how far the centre of the first is above a plane, how much each further one is above
    // the one before, and how far a centre may be if its cell meets the plane.
    struct Row {
        double height, step, reach;
    };
    template <class RowOf, class Body>
    void each_of(const PartRange& parts, const RowOf& row_of, const Body& body) const {
        const CellRange r = parts.cells();
        for (int z = r.lo[2]; z <= r.hi[2]; ++z)
            for (int y = r.lo[1]; y <= r.hi[1]; ++y) {
                const Row row = row_of(y, z);
                const size_t first = (size_t(z) * head_.cells[1] + size_t(y)) * head_.cells[0];
                const rt_u32 within = parts.within(1, y) | parts.within(2, z);
                for (int x = r.lo[0]; x <= r.hi[0]; ++x)
                    body(first + size_t(x), !(std::fabs(row.height + (x - r.lo[0]) * row.step) > row.reach),
                         within | parts.within(0, x));
            }
    }
};

// The primitives of all cells, in two steps: which cells each meets; then their lists, once it is known how much memory these
// take. Both run on all cores. Lists do not depend on the number of cores: they are in the order of the primitives.
//
// A counting sort of (cell, primitive). Tasks of the first step have some of the primitives, and sort their pairs by the
// upper bits of the cells. Tasks of the second step have a share of the cells, and take the pairs of all tasks before.
//
// kPlaced: it also notes where in each cell the primitive's box is.
template <class Head, bool kPlaced = false>
class CellSort {
 public:
    // number(i) is the group's number of primitive i of `count`. `head` and what `prims` names must outlive this.
    template <class Number>
    CellSort(const rt_host* host, const Head& head, const Prims& prims, rt_u32 count, const Number& number) : finder_(head) {
        while ((lists() - 1) >> shift_ >= kShares) ++shift_;
        if (count < 2 * kAtOnce) shift_ = 63;
        shares_ = rt_u32(((lists() - 1) >> shift_) + 1);
        chunks_.resize(std::max(count / kAtOnce, 1u));
        for_each(host, rt_u32(chunks_.size()), [&](rt_u32 c) {
            const auto end = [&](rt_u32 chunk) { return rt_u32(uint64_t{count} * chunk / chunks_.size()); };
            chunks_[c].fill(*this, prims, end(c), end(c + 1), number);
            if (chunks_.size() > 1) rt::progress(host, 0.5f);  // to notice a cancelled build
        });
        for (const Chunk& chunk : chunks_) references_ += chunk.pairs.size();
        if (references_ > 0xFFFFFFF0u) throw rt::fail(host, "the cells name more than 2^32 primitives: ask for fewer cells");
    }

    // One for each cell, and one of the huge primitives.
    size_t lists() const { return finder_.cells() + 1; }
    uint64_t references() const { return references_; }

    // The primitives of cell c become list[starts[c] - place] to list[starts[c + 1] - place - 1], each plus `first`; likewise
    // their `parts`, if placed. starts: lists() + 1 of them. Returns how many lists have a primitive.
    size_t write(const rt_host* host, rt_u32* starts, rt_u32* list, rt_u32 place, rt_u32 first, rt_u32* parts = nullptr) const {
        std::vector<rt_u32> before(shares_), filled(shares_);
        rt_u32 sum = 0;
        for (rt_u32 p = 0; p < shares_; ++p) {
            before[p] = sum;
            for (const Chunk& chunk : chunks_) sum += chunk.ends[p + 1] - chunk.ends[p];
        }
        starts[lists()] = place + sum;
        for_each(host, shares_, [&](rt_u32 p) {
            const size_t low = size_t{p} << shift_,
                         cells = shares_ == 1 ? lists() : std::min(lists() - low, size_t{1} << shift_);
            std::vector<rt_u32> at(cells);
            for (const Chunk& chunk : chunks_)
                for (rt_u32 i = chunk.ends[p]; i < chunk.ends[p + 1]; ++i) ++at[chunk.pairs[i].cell - low];
            rt_u32 next = before[p];
            for (size_t c = 0; c < cells; ++c) {
                const rt_u32 count = at[c];
                starts[low + c] = place + next, at[c] = next;
                next += count, filled[p] += count > 0;
            }
            for (const Chunk& chunk : chunks_)
                for (rt_u32 i = chunk.ends[p]; i < chunk.ends[p + 1]; ++i) {
                    const rt_u32 to = at[chunk.pairs[i].cell - low]++;
                    list[to] = first + chunk.pairs[i].prim;
                    if constexpr (kPlaced) parts[to] = chunk.pairs[i].parts;
                }
        });
        size_t all = 0;
        for (const rt_u32 count : filled) all += count;
        return all;
    }

 private:
    static constexpr rt_u32 kAtOnce = 4096;  // primitives of a task
    static constexpr rt_u32 kShares = 64;    // of the cells, at most

    struct Plain {
        rt_u32 cell, prim;
        void set(size_t in, rt_u32 which, rt_u32) { cell = rt_u32(in), prim = which; }
    };
    struct Placed : Plain {
        rt_u32 parts;
        void set(size_t in, rt_u32 which, rt_u32 where) { Plain::set(in, which, where), parts = where; }
    };
    using Pair = std::conditional_t<kPlaced, Placed, Plain>;
    struct Chunk {
        std::vector<Pair> pairs;   // share by share
        std::vector<rt_u32> ends;  // of each share, behind a 0

        template <class Number>
        void fill(const CellSort& sort, const Prims& prims, rt_u32 begin, rt_u32 end, const Number& number) {
            std::vector<Pair> found;
            found.reserve(4 * size_t{end - begin});
            Pair some[256];
            size_t count = 0;
            for (rt_u32 i = begin; i < end; ++i)
                sort.finder_.each(prims, number(i), [&](size_t cell, bool meets, rt_u32 where) {
                    some[count].set(cell, number(i), where);
                    count += meets;
                    if (count < std::size(some)) return;
                    found.insert(found.end(), some, some + count);
                    count = 0;
                });
            found.insert(found.end(), some, some + count);
            ends.assign(sort.shares_ + 1, 0);
            for (const Pair& pair : found) ++ends[sort.share_of(pair) + 1];
            if (sort.shares_ == 1 || found.size() > 0xFFFFFFF0u) return pairs.swap(found);  // so many are refused later
            for (rt_u32 p = 0; p < sort.shares_; ++p) ends[p + 1] += ends[p];
            std::vector<rt_u32> at(ends.begin(), ends.end() - 1);
            pairs.resize(found.size());
            for (const Pair& pair : found) pairs[at[sort.share_of(pair)]++] = pair;
        }
    };

    size_t share_of(const Pair& pair) const { return size_t{pair.cell} >> shift_; }  // shift_ is 63 where all is one share

    template <class Body>
    static void for_each(const rt_host* host, rt_u32 count, const Body& body) {
        if (count == 1) return body(0);
        rt::parallel_for(host, count, body);
    }

    CellFinder<Head> finder_;
    rt_u32 shift_ = 0, shares_ = 1;
    std::vector<Chunk> chunks_;
    uint64_t references_ = 0;
};

// The bounds of the primitives that are not huge.
struct Extent {
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    rt_u32 count = 0;

    void add(const rt_prim& p) {
        if (is_huge(p)) return;
        ++count;
        for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], double{p.lo[k]}), hi[k] = std::max(hi[k], double{p.hi[k]});
    }
};

inline Extent extent_of(const rt_host* host, const rt_prim* prims, rt_u32 count) {
    constexpr rt_u32 kAtOnce = 16384;
    std::vector<Extent> parts(count / kAtOnce + 1);
    const auto add = [&](rt_u32 part) {
        for (rt_u32 i = part * kAtOnce, end = std::min(count, i + kAtOnce); i < end; ++i) parts[part].add(prims[i]);
    };
    if (parts.size() > 1)
        rt::parallel_for(host, rt_u32(parts.size()), add);
    else
        add(0);
    Extent all;
    for (const Extent& part : parts) {
        all.count += part.count;
        for (int k = 0; k < 3; ++k) all.lo[k] = std::min(all.lo[k], part.lo[k]), all.hi[k] = std::max(all.hi[k], part.hi[k]);
    }
    return all;
}

}  // namespace clarity::space
