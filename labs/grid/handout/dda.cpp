// dda.cpp -- the lab's grid. You need not change it, and it is not handed in.
#include <algorithm>
#include <cmath>
#include <vector>

#include "rt_plugin.hpp"
// included after rt_plugin.hpp, because it uses its types:
#include "dda_types.h"

namespace {

constexpr double kCellsOfPrimitive = 2, kMostCells = 64;  // along an axis
// A primitive is in each cell that its box comes as near to, in cells. So a ray may be taken for one of the cell beside it,
// where it is that close to an edge, and loses nothing.
constexpr double kSlack = 0.01;

struct Grid {
    dda_grid head{};
    std::vector<std::vector<rt_u32>> lists;  // of each cell: numbers of primitives in the group

    explicit Grid(const rt_prim* prims, rt_u32 count) {
        double lo[3], size[3], longest = 0, volume = 1;
        for (int k = 0; k < 3; ++k) {
            double hi = -3e38, most = 0;
            lo[k] = 3e38;
            for (rt_u32 i = 0; i < count; ++i) {
                lo[k] = std::min(lo[k], double(prims[i].lo[k])), hi = std::max(hi, double(prims[i].hi[k]));
                most = std::max({most, std::fabs(double(prims[i].lo[k])), std::fabs(double(prims[i].hi[k]))});
            }
            size[k] = std::max({hi - lo[k], 1e-5 * most, 1e-30});
            longest = std::max(longest, size[k]);
        }
        for (double& extent : size) volume *= extent = std::max(extent, 1e-3 * longest);
        const double side = std::cbrt(volume / (kCellsOfPrimitive * std::max(count, 1u)));
        size_t all = 1;
        for (int k = 0; k < 3; ++k) {
            const double cells = std::clamp(std::floor(size[k] / side), 1.0, kMostCells);
            head.cells[k] = rt_u32(cells), all *= head.cells[k];
            const double margin = 2 * kSlack * size[k] / cells;
            lo[k] -= margin, size[k] = (size[k] + 2 * margin) / cells;
            head.size[k] = float(size[k]);
            head.box[k] = float(lo[k]), head.box[k + 3] = float(lo[k] + cells * size[k]);
        }
        // A box that no ray meets.
        if (count == 0) std::fill(head.box, head.box + 6, 3e38f);
        lists.resize(all);
        for (rt_u32 i = 0; i < count; ++i) {
            int from[3], to[3];
            for (int k = 0; k < 3; ++k) {
                const auto cell = [&](double place) {
                    return int(std::clamp(std::floor(place), 0.0, double(head.cells[k] - 1)));
                };
                from[k] = cell((prims[i].lo[k] - lo[k]) / size[k] - kSlack),
                to[k] = cell((prims[i].hi[k] - lo[k]) / size[k] + kSlack);
            }
            for (int z = from[2]; z <= to[2]; ++z)
                for (int y = from[1]; y <= to[1]; ++y)
                    for (int x = from[0]; x <= to[0]; ++x)
                        lists[(size_t(z) * head.cells[1] + size_t(y)) * head.cells[0] + size_t(x)].push_back(i);
        }
    }
};

int32_t build(const rt_host*, const rt_build_input* in, const rt_build_output* out) {
    std::vector<Grid> grids;
    uint64_t cells = 0, entries = 0, prims = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        grids.emplace_back(in->prims + in->groups[g].first, in->groups[g].count);
        cells += grids.back().lists.size() + 1, prims += in->groups[g].count;
        for (const auto& list : grids.back().lists) entries += list.size();
    }
    auto* const heads = rt::alloc<dda_grid>(out, 0, in->group_count);
    auto* const starts = rt::alloc<rt_u32>(out, 1, cells);
    auto* const places = rt::alloc<rt_u32>(out, 2, entries);
    rt_u32* const leaves = rt::leaves(out, prims);
    rt_u32 cell = 0, place = 0, leaf = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        heads[g] = grids[g].head, heads[g].first = cell;
        for (const auto& list : grids[g].lists) {
            starts[cell++] = place;
            for (const rt_u32 i : list) places[place++] = leaf + i;
        }
        starts[cell++] = place;
        for (rt_u32 i = 0; i < in->groups[g].count; ++i) leaves[leaf++] = in->prims[in->groups[g].first + i].ref;
        rt::root(out, g, g);
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "dda.inc"
};
constexpr rt_slot kSlots[] = {rt::slot<dda_grid>("dda_grids", "dda_grid"), rt::slot<rt_u32>("dda_starts", "uint"),
                              rt::slot<rt_u32>("dda_list", "uint")};
constexpr rt_accel kAccel = rt::accel(kSlots, rt::file(kFiles, "dda_types.h"), rt::file(kFiles, "dda.cl"), rt::guarded<build>,
                                      nullptr, rt::Traits().can(RT_TRAVERSES_SINGLE_RAYS));

}  // namespace

const rt_plugin rt_plugin_v1 = rt::accel_plugin("dda", "Walk through a grid", "1.0.0", nullptr, kAccel);
