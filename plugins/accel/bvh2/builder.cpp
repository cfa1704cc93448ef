#include "builder.hpp"

#include <numeric>

#include "rt_plugin.hpp"
#include "statistics.hpp"

namespace bvh2 {

// Part of a range that one thread takes.
struct Builder::Chunk {
    uint32_t owner;  // range of the level, or group
    uint32_t begin, end;
    uint32_t left = 0, right = 0;  // where its primitives go
    Box box, centroids2;           // of its primitives
    Box left_centroids2, right_centroids2;
};

// What becomes of a range.
struct Builder::Cut {
    uint32_t first_chunk, chunk_count;
    bool binned = false;
    uint32_t bin_count = 0;
    Split split;
    Range left, right;
};

Builder::Builder(const rt_host* host, const rt_build_input& input, const Rules& rules, uint64_t primitive_count)
    : host_(host),
      input_(input),
      primitive_count_(primitive_count),
      work_total_(2 * primitive_count + 1),
      records_{Scratch<Record>(primitive_count), Scratch<Record>(primitive_count)},
      nodes_(primitive_count),
      workspace_{rules, {records_[0].data(), records_[1].data()}, nodes_.data(), nullptr},
      roots_(input.group_count),
      boxes_(input.group_count) {}

template <class Body>
void Builder::parallel_for(size_t count, Body&& body) const {
    rt::parallel_for(host_, static_cast<rt_u32>(count), std::forward<Body>(body));
}

// Throws where the user cancelled.
void Builder::report(uint64_t work) {
    const uint64_t done = work_done_ += work;
    rt::progress(host_,
                 static_cast<float>(static_cast<double>(std::min(done, work_total_)) / static_cast<double>(work_total_)));
}

void Builder::run(const rt_build_output* out) {
    workspace_.leaves = rt::leaves(out, primitive_count_);
    split_top(load());
    run_tasks();
    write_nodes(out);
}

// Copies the primitives, one group after the other, and bounds each group.
std::vector<Builder::Pending> Builder::load() {
    std::vector<Pending> groups;
    std::vector<Chunk> chunks;
    uint32_t at = 0;
    for (uint32_t g = 0; g < input_.group_count; ++g) {
        Pending pending{{}, RT_NONE, g};
        pending.range.begin = at;
        pending.range.end = at + input_.groups[g].count;
        for (; at < pending.range.end; at = chunks.back().end)
            chunks.push_back({g, at, std::min(at + kChunkSize, pending.range.end), 0, 0, {}, {}, {}, {}});
        groups.push_back(pending);
    }
    parallel_for(chunks.size(), [&](uint32_t i) {
        Chunk& chunk = chunks[i];
        const rt_prim* prim = input_.prims + input_.groups[chunk.owner].first + (chunk.begin - groups[chunk.owner].range.begin);
        const Vec4 least = splat(-FLT_MAX), most = splat(FLT_MAX);
        for (uint32_t at_record = chunk.begin; at_record < chunk.end; ++at_record, ++prim) {
            // A bound that is no number becomes the farthest one (MINPS and MAXPS give their second operand), and bounds in the
            // wrong order are put right: whatever comes in, the box is sound and nothing is lost.
            Record& record = records_[0].data()[at_record];
            const float p_lo[4] = {prim->lo[0], prim->lo[1], prim->lo[2], 0.0f},
                        p_hi[4] = {prim->hi[0], prim->hi[1], prim->hi[2], 0.0f};
            const Vec4 lo = min(max(load_any(p_lo), least), most), hi = max(min(load_any(p_hi), most), least);
            store(record.lo, min(lo, hi));
            store(record.hi, max(lo, hi));
            record.set_ref(prim->ref);
            chunk.box.add(record.box());
            chunk.centroids2.add(record.centroid2());
        }
    });
    for (const Chunk& chunk : chunks) {
        groups[chunk.owner].range.box.add(chunk.box);
        groups[chunk.owner].range.centroids2.add(chunk.centroids2);
    }
    for (uint32_t g = 0; g < input_.group_count; ++g) boxes_[g] = groups[g].range.box;
    report(primitive_count_ / 2);
    return groups;
}

void Builder::put(const Pending& pending, TopChild child) {
    if (pending.parent == RT_NONE)
        roots_[pending.which] = child;
    else
        top_[pending.parent].child[pending.which] = child;
}

void Builder::split_top(std::vector<Pending> level) {
    while (!level.empty()) {
        std::vector<Pending> large;
        for (const Pending& pending : level) {
            if (pending.range.count() > kTaskSize) {
                large.push_back(pending);
                continue;
            }
            put(pending, {true, static_cast<uint32_t>(tasks_.size())});
            tasks_.push_back(pending.range);
        }
        level = split_level(large);
        report(0);
    }
}

std::vector<Builder::Pending> Builder::split_level(const std::vector<Pending>& level) {
    std::vector<Cut> cuts(level.size());
    std::vector<Chunk> chunks;
    for (uint32_t i = 0; i < level.size(); ++i) {
        const Range& range = level[i].range;
        cuts[i].first_chunk = static_cast<uint32_t>(chunks.size());
        cuts[i].binned = may_use_heuristic(workspace_.rules, range);
        cuts[i].bin_count = bins_for(workspace_.rules, range.count());
        for (uint32_t at = range.begin; at < range.end; at = chunks.back().end)
            chunks.push_back({i, at, std::min(at + kChunkSize, range.end), 0, 0, {}, {}, {}, {}});
        cuts[i].chunk_count = static_cast<uint32_t>(chunks.size()) - cuts[i].first_chunk;
    }

    // Bin every chunk.
    Scratch<Bins> chunk_bins(chunks.size());
    parallel_for(chunks.size(), [&](uint32_t c) {
        const Cut& cut = cuts[chunks[c].owner];
        if (!cut.binned) return;
        const Range& range = level[chunks[c].owner].range;
        const Record* records = workspace_.records[range.buffer];
        chunk_bins.data()[c].clear(cut.bin_count);
        chunk_bins.data()[c].add(records + chunks[c].begin, records + chunks[c].end, Slices(range.centroids2, cut.bin_count));
    });

    // Choose each range's plane, and from the chunks' counts the places where each one's primitives will go.
    parallel_for(level.size(), [&](uint32_t i) {
        const Range& range = level[i].range;
        Cut& cut = cuts[i];
        Chunk* const first = chunks.data() + cut.first_chunk;
        const Bins* const bins = chunk_bins.data() + cut.first_chunk;
        if (cut.binned) {
            Bins sum;
            sum.clear(cut.bin_count);
            for (uint32_t c = 0; c < cut.chunk_count; ++c) sum.add(bins[c], cut.bin_count);
            cut.split = find_split(sum, cut.bin_count, AreaScale(range.box), range.count());
            cut.binned = cut.split.cost < INFINITY;
        }
        if (!cut.binned) {
            halve(workspace_.records[range.buffer], range, cut.left, cut.right);
            return;
        }
        begin_split(range, cut.split, cut.left, cut.right);
        uint32_t left = cut.left.begin, right = cut.right.begin;
        for (uint32_t c = 0; c < cut.chunk_count; ++c) {
            first[c].left = left;
            first[c].right = right;
            uint32_t goes_left = 0;
            for (uint32_t b = 0; b < cut.split.bin; ++b) goes_left += bins[c].count[b][cut.split.axis];
            left += goes_left;
            right += first[c].end - first[c].begin - goes_left;
        }
    });

    // Move every chunk.
    parallel_for(chunks.size(), [&](uint32_t c) {
        Chunk& chunk = chunks[c];
        const Cut& cut = cuts[chunk.owner];
        if (!cut.binned) return;
        const Range& range = level[chunk.owner].range;
        const Record* const from = workspace_.records[range.buffer];
        Record* const to = workspace_.records[range.buffer ^ 1];
        scatter(from + chunk.begin, from + chunk.end, Slices(range.centroids2, cut.bin_count), cut.split, to + chunk.left,
                to + chunk.right, chunk.left_centroids2, chunk.right_centroids2);
    });

    std::vector<Pending> next;
    for (uint32_t i = 0; i < level.size(); ++i) {
        Cut& cut = cuts[i];
        for (uint32_t c = cut.first_chunk; cut.binned && c < cut.first_chunk + cut.chunk_count; ++c) {
            cut.left.centroids2.add(chunks[c].left_centroids2);
            cut.right.centroids2.add(chunks[c].right_centroids2);
        }
        if (right_is_larger(cut.left, cut.right)) std::swap(cut.left, cut.right);
        const uint32_t node = static_cast<uint32_t>(top_.size());
        put(level[i], {false, node});
        top_.push_back({{cut.left.box, cut.right.box}, {}, 0});
        next.push_back({cut.left, node, 0});
        next.push_back({cut.right, node, 1});
    }
    return next;
}

void Builder::run_tasks() {
    subtrees_.resize(tasks_.size());
    // The largest first, so that no thread is left alone with one at the end.
    std::vector<uint32_t> order(tasks_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return tasks_[a].count() > tasks_[b].count(); });
    parallel_for(order.size(), [&](uint32_t i) {
        const Range& range = tasks_[order[i]];
        if (range.count() > 0) subtrees_[order[i]] = build_subtree(workspace_, range);
        report(range.count());
    });
}

// Gives the nodes of a subtree of the top their places, in depth-first order from `next` on; returns the next free one.
rt_u32 Builder::place(TopChild child, rt_u32 next) {
    if (child.is_task) {
        task_place_[child.index] = next;
        return next + subtrees_[child.index].nodes;
    }
    TopNode& node = top_[child.index];
    node.place = next++;
    next = place(node.child[0], next);
    return place(node.child[1], next);
}

void Builder::write_nodes(const rt_build_output* out) {
    task_place_.resize(tasks_.size());
    std::vector<rt_u32> roots(roots_.size());
    rt_u32 count = 0;
    for (size_t g = 0; g < roots_.size(); ++g) {
        roots[g] = count;
        const bool has_node = !roots_[g].is_task || subtrees_[roots_[g].index].nodes > 0;
        count = has_node ? place(roots_[g], count) : count + 1;
    }
    bvh2_node* const nodes = rt::alloc<bvh2_node>(out, 0, count);

    parallel_for(tasks_.size(), [&](uint32_t t) {
        const bvh2_node* from = workspace_.nodes + tasks_[t].begin;
        for (uint32_t i = 0; i < subtrees_[t].nodes; ++i) {
            bvh2_node node = from[i];
            if (!(node.child0 & BVH2_LEAF)) node.child0 += task_place_[t];
            if (!(node.child1 & BVH2_LEAF)) node.child1 += task_place_[t];
            nodes[task_place_[t] + i] = node;
        }
    });
    const auto code = [&](TopChild child) {
        if (!child.is_task) return top_[child.index].place;
        const Subtree& subtree = subtrees_[child.index];
        return subtree.nodes > 0 ? task_place_[child.index] : subtree.root;
    };
    for (const TopNode& node : top_)
        for (int which = 0; which < 2; ++which) set_child(nodes[node.place], which, node.box[which], code(node.child[which]));
    const Box nowhere{splat(FLT_MAX), splat(FLT_MAX)};
    for (uint32_t g = 0; g < roots.size(); ++g) {
        if (roots_[g].is_task && subtrees_[roots_[g].index].nodes == 0) {
            const bool empty = input_.groups[g].count == 0;
            set_child(nodes[roots[g]], 0, empty ? nowhere : boxes_[g], empty ? BVH2_MAKE_LEAF(0u, 0u) : code(roots_[g]));
            set_child(nodes[roots[g]], 1, nowhere, BVH2_MAKE_LEAF(0u, 0u));
        }
        rt::root(out, g, roots[g]);
    }
    uint32_t depth = 1;
    for (const Subtree& subtree : subtrees_) depth = std::max(depth, subtree.depth);
    const Statistics statistics = measure(host_, workspace_.rules, nodes, count, roots, input_.groups);
    rt::stat(out, "nodes", count);
    rt::stat(out, "leaves", static_cast<double>(statistics.leaves));
    rt::stat(out, "depth", depth);
    rt::stat(out, "sah_cost", statistics.sah_cost);
    rt::stat(out, "build_bytes", static_cast<double>(primitive_count_ * kBytesPerPrimitive));
    // One place a level, and one to spare that tells a full stack from an overflowing one; in steps of 8, since a new value
    // recompiles the kernels.
    rt::define(out, "BVH2_STACK", (depth + 1 + 7) / 8 * 8);
}

}  // namespace bvh2
