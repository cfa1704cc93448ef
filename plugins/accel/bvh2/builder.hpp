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

#include "kernels.hpp"
#include "morton.hpp"
#include "rt_plugin.hpp"
#include "scratch.hpp"
#include "spatial.hpp"

namespace bvh2 {

// A range that one thread builds, and its tree. The nodes of the tree begin at first_node.
struct Task {
    Range range;
    uint32_t first_node;
    float scale;  // unit_scale() of the group's box
    Subtree tree;
};
// An inner node above the tasks.
struct Top {
    rt_u32 node;
    float scale;
};
// The root of a group's tree: a node or a leaf. The code is RT_NONE if the group is empty.
struct Root {
    Bounds box;
    rt_u32 code = RT_NONE;
};
// A finished tree. Its nodes are still where the builder put them (see Workspace::nodes), and child codes are indices into that
// array.
struct BinaryTree {
    const bvh2_node* nodes;
    std::vector<Task> tasks;
    std::vector<Top> tops;    // parents before children
    std::vector<Root> roots;  // of groups
    uint64_t leaf_count = 0;  // number of refs in leaf order
    uint32_t depth = 1;       // number of nodes on the path from a root to the deepest leaf
};

// Returns the factor from half a length to that length in units of the box's longest side. Returns FLT_MAX for a box without
// extent.
float unit_scale(const Bounds& box);

class Builder {
 public:
    // A position in leaf order has 28 bits, like the index in a ref.
    static constexpr uint64_t kMaxPrimitives = RT_REF_INDEX_MAX;
    // Returns an upper bound of the temporary memory of a build, in bytes. The builder frees it when it is destroyed.
    static uint64_t bytes(const Rules& rules, uint64_t primitive_count);

    // Reports progress from 0 to `share`. The tree's nodes live as long as this builder.
    Builder(const rt_host* host, const rt_build_input& input, const Rules& rules, uint64_t primitive_count, float share);
    // Builds the tree and writes the leaf order to `out`. Calls `after` once for each finished task, on the thread that built
    // it, while that thread's caches still hold it. Throws if the user cancels, or if memory is short.
    BinaryTree run(const rt_build_output* out, const std::function<void(const Task&)>& after);
    const Workspace& workspace() const { return workspace_; }

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

    std::vector<Pending> load();
    void add_task(const Pending& pending);
    // Makes a task of each range that is small enough, and returns the other ranges.
    std::vector<Pending> part_tasks(const std::vector<Pending>& level);
    void split_top(std::vector<Pending> level);
    std::vector<Pending> split_level(const std::vector<Pending>& level);
    void build_sorted(const std::function<void(const Task&)>& after);
    void split_space(std::vector<Pending> level, const rt_build_output* out);
    void close_gaps(const std::vector<uint32_t>& counts, const rt_build_output* out);
    void run_tasks(const std::function<void(uint32_t)>& run_task);
    void put(const Pending& pending, rt_u32 code);
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
    Scratch<bvh2_node> nodes_;
    Workspace workspace_;
    BinaryTree tree_;
    std::vector<Pending> task_place_;  // of each task; the ranges are left empty
    std::vector<float> scales_;        // of groups
    std::atomic<uint64_t> work_done_{0};
};

}  // namespace bvh2
