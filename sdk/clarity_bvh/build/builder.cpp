#include "clarity_bvh/build/builder.hpp"

#include <cstdio>
#include <memory>
#include <numeric>

#include "clarity_bvh/build/reinsert.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {
namespace {

constexpr float kBuiltShare = 0.1f;  // of the time of a build with reinsertion

// At most 16384 records (0.5 MiB) per task, so that they fit into a core's own cache. Small scenes get smaller tasks, so that
// none of many cores runs out of work before the end: they are no fewer for fewer cores, as the tree must be the same
// everywhere.
uint32_t task_size_for(uint64_t primitive_count) {
    return static_cast<uint32_t>(std::clamp<uint64_t>(primitive_count / 64, 512, 16384));
}
// The sorted builder (Method::morton) needs no records.
uint64_t record_count(const Rules& rules, uint64_t room) {
    return rules.method == Method::morton ? 0 : room;
}
uint32_t chunk_size_for(uint64_t primitive_count) {
    return static_cast<uint32_t>(std::clamp<uint64_t>(primitive_count / 16, 1024, 8192));
}

}  // namespace

// The part of a range that one thread bins and moves.
struct TopologyBuilder::Chunk {
    uint32_t owner = 0;  // index of the range in its level; in load(): the group
    uint32_t begin = 0, end = 0;
    uint32_t left = 0, right = 0;  // first positions of its left and right primitives after the split
    Bounds box, centroids2;        // of all its primitives
    Bounds left_centroids2, right_centroids2;
};

// How one range of a level is split.
struct TopologyBuilder::Cut {
    uint32_t first_chunk, chunk_count;
    bool binned = false;
    uint32_t bin_count = 0;
    Split split;
    Range left, right;
};

uint64_t TopologyBuilder::room(const Rules& rules, uint64_t primitive_count) {
    if (rules.method != Method::spatial) return primitive_count;
    const double all = static_cast<double>(primitive_count) * (1 + static_cast<double>(rules.duplicates));
    return std::max(primitive_count, std::min(static_cast<uint64_t>(all), kMaxPrimitives));
}

uint64_t TopologyBuilder::bytes(const Rules& rules, uint64_t primitive_count) {
    if (rules.method == Method::morton) return primitive_count * sizeof(Node) + MortonOrder::bytes(primitive_count);
    const size_t more = rules.method == Method::spatial ? sizeof(rt_u32) : 0;
    return room(rules, primitive_count) * (2 * sizeof(Record) + sizeof(Node) + more);
}

TopologyBuilder::TopologyBuilder(const rt_host* host, const rt_build_input& input, const Rules& rules, uint64_t primitive_count,
                                 float share)
    : host_(host),
      input_(input),
      primitive_count_(primitive_count),
      room_(room(rules, primitive_count)),
      work_total_(2 * primitive_count + 1),
      share_(share),
      task_size_(task_size_for(primitive_count)),
      chunk_size_(chunk_size_for(primitive_count)),
      kernels_(kernels()),
      records_{Scratch<Record>(record_count(rules, room_)), Scratch<Record>(record_count(rules, room_))},
      tree_{Scratch<Node>(room_), {}, {}, std::vector<Root>(input.group_count)},
      tree_nodes_(tree_.nodes.data()),
      workspace_{rules, {records_[0].data(), records_[1].data()}, tree_nodes_, nullptr} {}

// Adds `work` to the progress. Throws if the user has cancelled the build.
void TopologyBuilder::report(uint64_t work) {
    const uint64_t done = std::min(work_done_ += work, work_total_);
    rt::progress(host_, share_ * static_cast<float>(static_cast<double>(done) / static_cast<double>(work_total_)));
}

Topology TopologyBuilder::run(const RefMemory& refs, const std::function<void(const Part&)>& after) {
    const bool spatial = workspace_.rules.method == Method::spatial;
    if (!spatial) workspace_.leaves = refs(primitive_count_);
    tree_.ref_count = primitive_count_;
    if (workspace_.rules.method == Method::morton) {
        build_sorted(after);
    } else if (spatial) {
        split_space(load(), refs);
        parallel_for(tree_.parts.size(), [&](uint32_t t) { after(tree_.parts[t]); });
    } else {
        split_top(load());
        run_tasks([&](uint32_t t) {
            const Range& range = tasks_[t].range;
            set_part(t, kernels_.build_subtree(workspace_, range, tree_.parts[t].first_node, range.begin));
            put(tasks_[t], tree_.parts[t].root);
            after(tree_.parts[t]);
        });
    }
    for (const Part& part : tree_.parts) tree_.depth = std::max(tree_.depth, part.depth);
    return std::move(tree_);
}

void TopologyBuilder::add_chunks(std::vector<Chunk>& chunks, uint32_t owner, const Range& range) const {
    for (uint32_t at = range.begin; at < range.end; at = chunks.back().end) {
        Chunk& chunk = chunks.emplace_back();
        chunk.owner = owner, chunk.begin = at, chunk.end = std::min(at + chunk_size_, range.end);
    }
}

// Copies the primitives of all groups into records, group by group, and computes the bounds of each group.
std::vector<TopologyBuilder::Pending> TopologyBuilder::load() {
    std::vector<Pending> groups;
    std::vector<Chunk> chunks;
    groups.reserve(input_.group_count);
    uint64_t before = 0;
    for (uint32_t g = 0; g < input_.group_count; ++g) {
        Pending pending{{}, RT_NONE, g, g, 0, 0};
        // The room is divided among the groups in proportion to their primitives.
        const auto place = [&](uint64_t primitives) {
            return static_cast<uint32_t>(primitives +
                                         (room_ - primitive_count_) * primitives / std::max<uint64_t>(primitive_count_, 1));
        };
        pending.room_begin = place(before);
        pending.room_end = place(before + input_.groups[g].count);
        before += input_.groups[g].count;
        pending.range.begin = pending.room_begin;
        pending.range.end = pending.room_begin + input_.groups[g].count;
        add_chunks(chunks, g, pending.range);
        groups.push_back(pending);
    }
    parallel_for(chunks.size(), [&](uint32_t i) {
        Chunk& chunk = chunks[i];
        const rt_prim* prim = input_.prims + input_.groups[chunk.owner].first + (chunk.begin - groups[chunk.owner].range.begin);
        Record* const records = records_[0].data();
        for (uint32_t r = chunk.begin; r < chunk.end; ++r, ++prim) {
            fetch(prim + kStreamAhead);
            Vec4 lo, neg_hi;
            sound_box(*prim, lo, neg_hi);
            store(records[r].lo, lo);
            store(records[r].neg_hi, neg_hi);
            records[r].set_ref(prim->ref);
        }
        bound(records + chunk.begin, records + chunk.end, chunk.box, chunk.centroids2);
    });
    for (const Chunk& chunk : chunks) {
        groups[chunk.owner].range.box.add(chunk.box);
        groups[chunk.owner].range.centroids2.add(chunk.centroids2);
    }
    for (uint32_t g = 0; g < input_.group_count; ++g) {
        tree_.roots[g].box = groups[g].range.box;
        scales_.push_back(unit_scale(tree_.roots[g].box));
    }
    report(primitive_count_ / 2);
    return groups;
}

void TopologyBuilder::put(const Pending& pending, uint32_t code) {
    if (pending.parent == RT_NONE)
        tree_.roots[pending.which].code = code;
    else
        (pending.which == 0 ? tree_nodes_[pending.parent].child0 : tree_nodes_[pending.parent].child1) = code;
}

void TopologyBuilder::set_part(uint32_t t, const Subtree& tree) {
    Part& part = tree_.parts[t];
    part.root = tree.root;
    part.node_count = tree.nodes;
    part.depth = tree.depth;
}

void TopologyBuilder::add_task(const Pending& pending) {
    tree_.parts.push_back({pending.room_begin, scales_[pending.group]});
    tasks_.push_back(pending);
}

std::vector<TopologyBuilder::Pending> TopologyBuilder::part_tasks(const std::vector<Pending>& level) {
    std::vector<Pending> large;
    for (const Pending& pending : level) {
        if (pending.range.count() > task_size_)
            large.push_back(pending);
        else if (pending.range.count() > 0)
            add_task(pending);
    }
    return large;
}

void TopologyBuilder::split_top(std::vector<Pending> level) {
    while (!level.empty()) {
        level = split_level(part_tasks(level));
        report(0);
    }
}

std::vector<TopologyBuilder::Pending> TopologyBuilder::split_level(const std::vector<Pending>& level) {
    std::vector<Cut> cuts(level.size());
    std::vector<Chunk> chunks;
    for (uint32_t i = 0; i < level.size(); ++i) {
        const Range& range = level[i].range;
        cuts[i].first_chunk = static_cast<uint32_t>(chunks.size());
        cuts[i].binned = may_bin(workspace_.rules, range);
        cuts[i].bin_count = bins_for(workspace_.rules, range.count());
        add_chunks(chunks, i, range);
        cuts[i].chunk_count = static_cast<uint32_t>(chunks.size()) - cuts[i].first_chunk;
    }

    // 1. Bin every chunk.
    Scratch<Bins> chunk_bins(chunks.size());
    parallel_for(chunks.size(), [&](uint32_t c) {
        const Cut& cut = cuts[chunks[c].owner];
        if (!cut.binned) return;
        const Range& range = level[chunks[c].owner].range;
        const Record* records = workspace_.records[range.buffer];
        kernels_.clear(chunk_bins.data()[c], cut.bin_count);
        kernels_.bin(records + chunks[c].begin, records + chunks[c].end, Slices(range.centroids2, cut.bin_count),
                     chunk_bins.data()[c]);
    });

    // 2. Choose the plane of each range. The counts of its chunks then say where the primitives of each chunk go.
    parallel_for(level.size(), [&](uint32_t i) {
        const Range& range = level[i].range;
        Cut& cut = cuts[i];
        Chunk* const first = chunks.data() + cut.first_chunk;
        const Bins* const bins = chunk_bins.data() + cut.first_chunk;
        if (cut.binned) {
            Bins sum;
            kernels_.clear(sum, cut.bin_count);
            for (uint32_t c = 0; c < cut.chunk_count; ++c) kernels_.merge(bins[c], cut.bin_count, sum);
            kernels_.find_split(sum, cut.bin_count, AreaScale(range.box), range.count(), cut.split);
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

    // 3. Move the primitives of every chunk.
    parallel_for(chunks.size(), [&](uint32_t c) {
        Chunk& chunk = chunks[c];
        const Cut& cut = cuts[chunk.owner];
        if (!cut.binned) return;
        const Range& range = level[chunk.owner].range;
        const Record* const from = workspace_.records[range.buffer];
        Record* const to = workspace_.records[range.buffer ^ 1];
        kernels_.scatter(from + chunk.begin, from + chunk.end, Slices(range.centroids2, cut.bin_count), cut.split,
                         to + chunk.left, to + chunk.right, chunk.left_centroids2, chunk.right_centroids2);
    });

    std::vector<Pending> next;
    for (uint32_t i = 0; i < level.size(); ++i) {
        Cut& cut = cuts[i];
        for (uint32_t c = cut.first_chunk; cut.binned && c < cut.first_chunk + cut.chunk_count; ++c) {
            cut.left.centroids2.add(chunks[c].left_centroids2);
            cut.right.centroids2.add(chunks[c].right_centroids2);
        }
        const uint32_t node = cut.left.end - 1;  // see Workspace::nodes
        if (right_is_larger(AreaScale(level[i].range.box), cut.left, cut.right)) std::swap(cut.left, cut.right);
        put(level[i], node);
        tree_.tops.push_back({node, scales_[level[i].group]});
        set_child(tree_nodes_[node], 0, cut.left.box, 0);
        set_child(tree_nodes_[node], 1, cut.right.box, 0);
        next.push_back({cut.left, node, 0, level[i].group, cut.left.begin, cut.left.end});
        next.push_back({cut.right, node, 1, level[i].group, cut.right.begin, cut.right.end});
    }
    return next;
}

void TopologyBuilder::run_tasks(const std::function<void(uint32_t)>& run_task) {
    // Largest tasks first, so that no thread starts a large one at the end while the others are idle.
    std::vector<uint32_t> order(tasks_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return tasks_[a].range.count() > tasks_[b].range.count(); });
    parallel_for(order.size(), [&](uint32_t i) {
        run_task(order[i]);
        report(tasks_[order[i]].range.count());
    });
}

uint64_t count_primitives(const rt_host* host, const rt_build_input& input) {
    uint64_t count = 0;
    for (uint32_t g = 0; g < input.group_count; ++g) count += input.groups[g].count;
    if (count <= kMaxPrimitives) return count;
    char why[160];
    std::snprintf(why, sizeof why, "holds %llu primitives at most, the scene has %llu: instance meshes, or leave some out",
                  static_cast<unsigned long long>(kMaxPrimitives), static_cast<unsigned long long>(count));
    throw rt::fail(host, why);
}

void fail_for_memory(const rt_host* host, uint64_t primitive_count, uint64_t bytes) {
    char why[160];
    std::snprintf(why, sizeof why,
                  "cannot allocate the %.1f GiB that building a tree of %llu primitives takes: free memory, or instance meshes",
                  static_cast<double>(bytes) / (1 << 30), static_cast<unsigned long long>(primitive_count));
    throw rt::fail(host, why);
}

uint64_t build_bytes(const Rules& rules, uint64_t primitive_count) {
    const uint64_t built = TopologyBuilder::bytes(rules, primitive_count);
    return rules.reinsert == 0 ? built : std::max(built, reinsert_bytes(primitive_count));
}

Topology build_topology(const rt_host* host, const rt_build_input& input, const Rules& rules, const RefMemory& refs,
                        float share) {
    const uint64_t count = count_primitives(host, input);
    return with_memory_for(host, count, build_bytes(rules, count), [&] {
        if (rules.reinsert == 0) return TopologyBuilder(host, input, rules, count, share).run(refs, [](const Part&) {});
        // Leaves of one primitive each: every primitive may find its place, and reinsert() joins them.
        Rules single = rules;
        single.max_leaf = 1;
        std::unique_ptr<Scratch<uint32_t>> single_refs;
        Topology tree = TopologyBuilder(host, input, single, count, kBuiltShare * share)
                            .run(
                                [&](uint64_t ref_count) {
                                    single_refs = std::make_unique<Scratch<uint32_t>>(ref_count);
                                    return single_refs->data();
                                },
                                [](const Part&) {});
        return reinsert(host, std::move(tree), rules, single_refs->data(), refs, kBuiltShare * share, share);
    });
}

}  // namespace clarity::bvh
