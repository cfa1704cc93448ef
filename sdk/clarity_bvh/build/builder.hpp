// builder.hpp -- builds one binary tree per group from the host's primitives, on all cores.
//
// Large ranges are split breadth-first. All ranges of a level are split together: each is cut into chunks, which the threads
// bin and move in parallel. A range that is small enough becomes a task, which one thread builds. The chunk boundaries depend
// on the input only, and the results of the threads are merged in chunk order. So the tree does not depend on the number of
// threads.
#pragma once
#include <atomic>
#include <functional>
#include <vector>

#include "clarity_bvh/base/scratch.hpp"
#include "clarity_bvh/build/morton.hpp"
#include "clarity_bvh/build/spatial.hpp"
#include "clarity_bvh/kernels/kernels.hpp"
#include "clarity_bvh/topology.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// Builds the trees of all groups by the rules. Throws rt::Stopped, with the host told why, if there are more than
// kMaxPrimitives or if memory is short; rt::Cancelled if the user cancels. `input` is read during the call only. Reports
// progress from 0 to `share`.
Topology build_topology(const rt_host* host, const rt_build_input& input, const Rules& rules, const RefMemory& refs,
                        float share = 1.0f);
// Returns an upper bound of the memory of build_topology(), in bytes, nodes of the topology included.
uint64_t build_bytes(const Rules& rules, uint64_t primitive_count);

// Returns the number of primitives of all groups. Throws rt::Stopped, with the host told why, if they are more than
// kMaxPrimitives.
uint64_t count_primitives(const rt_host* host, const rt_build_input& input);

// Calls build() and passes on what it returns. Where memory is short, it tells the host how many bytes the build takes, and
// throws rt::Stopped.
template <class Build>
auto with_memory_for(const rt_host* host, uint64_t primitive_count, uint64_t bytes, Build&& build) -> decltype(build());
[[noreturn]] void fail_for_memory(const rt_host* host, uint64_t primitive_count, uint64_t bytes);

// The same as build_topology() in steps, for packers that work on each part while the caches of its thread hold it.
class TopologyBuilder {
 public:
    // Returns an upper bound of the temporary memory of a build, in bytes, nodes of the topology included.
    static uint64_t bytes(const Rules& rules, uint64_t primitive_count);

    // Reports progress from 0 to `share`. `host` and `input` must outlive the builder. primitive_count: of all groups.
    TopologyBuilder(const rt_host* host, const rt_build_input& input, const Rules& rules, uint64_t primitive_count,
                    float share);
    // Builds the tree and writes the leaf order. Calls `after` once for each finished part, on the thread that built it, while
    // that thread's caches still hold it. Call run() once. Throws as build_topology() does.
    Topology run(const RefMemory& refs, const std::function<void(const Part&)>& after);

    // The nodes of the topology that run() will return, for `after`. They stay where they are.
    Node* nodes() const { return tree_nodes_; }
    // Memory of 32 bytes for each node, at the node's index. The memory of a part's nodes is free for `after` as soon as the
    // part is finished, all of it after run(). It lives as long as this builder. Without use for Method::morton, which needs
    // none.
    void* spare() const { return records_[0].data(); }

 private:
    // A range that is not yet split, and the parent that its tree's code is written to.
    struct Pending {
        Range range;
        uint32_t parent;  // node index; RT_NONE: the range is the root of its group
        uint32_t which;   // 0 or 1: child of the parent; without a parent: the group
        uint32_t group;
        uint32_t room_begin, room_end;  // see RoomyRange
    };
    struct Chunk;
    struct Cut;

    void add_chunks(std::vector<Chunk>& chunks, uint32_t owner, const Range& range) const;
    std::vector<Pending> load();
    void add_task(const Pending& pending);
    // Makes a task of each range that is small enough, and returns the other ranges.
    std::vector<Pending> part_tasks(const std::vector<Pending>& level);
    void split_top(std::vector<Pending> level);
    std::vector<Pending> split_level(const std::vector<Pending>& level);
    void build_sorted(const std::function<void(const Part&)>& after);
    void split_space(std::vector<Pending> level, const RefMemory& refs);
    void close_gaps(const std::vector<uint32_t>& counts, const RefMemory& refs);
    void run_tasks(const std::function<void(uint32_t)>& run_task);
    void put(const Pending& pending, uint32_t code);
    void set_part(uint32_t t, const Subtree& tree);
    void report(uint64_t work);
    template <class Body>
    void parallel_for(size_t count, Body&& body) const {
        rt::parallel_for(host_, static_cast<rt_u32>(count), std::forward<Body>(body));
    }
    static uint64_t room(const Rules& rules, uint64_t primitive_count);

    const rt_host* const host_;
    const rt_build_input& input_;
    const uint64_t primitive_count_, room_, work_total_;
    const float share_;
    const uint32_t task_size_, chunk_size_;
    const Kernels& kernels_;
    Scratch<Record> records_[2];
    Topology tree_;
    Node* const tree_nodes_;
    Workspace workspace_;
    std::vector<Pending> tasks_;  // tasks_[t] becomes tree_.parts[t]
    std::vector<float> scales_;   // of groups
    std::atomic<uint64_t> work_done_{0};
};

template <class Build>
auto with_memory_for(const rt_host* host, uint64_t primitive_count, uint64_t bytes, Build&& build) -> decltype(build()) {
    try {
        return build();
    } catch (const std::bad_alloc&) {
        fail_for_memory(host, primitive_count, bytes);
    }
}

}  // namespace clarity::bvh
