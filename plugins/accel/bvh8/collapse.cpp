#include "collapse.hpp"

#include <algorithm>

#include "rt_plugin.hpp"

namespace bvh8 {
namespace {

constexpr rt_u32 kTaskNodes = 4096;

bool is_leaf(rt_u32 code) {
    return (code & BVH2_LEAF) != 0;
}
bool is_nothing(rt_u32 code) {
    return code == BVH2_MAKE_LEAF(0u, 0u);
}
Child left_of(const bvh2_node& node) {
    return {node.box0, node.child0};
}
Child right_of(const bvh2_node& node) {
    return {node.box1, node.child1};
}

// Added to each side, so that lines and points do not cost nothing: too little to matter to what has an area.
constexpr double kLeast = 1e-12;

// Half the area of the smallest box around both. In double, where no float overflows.
double half_area(const bvh2_node& node, double scale) {
    double e[3];
    for (int a = 0; a < 3; ++a)
        e[a] = kLeast + scale * (double{std::max(node.box0[3 + a], node.box1[3 + a])} - std::min(node.box0[a], node.box1[a]));
    return e[0] * e[1] + e[2] * (e[0] + e[1]);
}
double half_area(const float box[6], double scale) {
    double e[3];
    for (int a = 0; a < 3; ++a) e[a] = kLeast + scale * (double{box[3 + a]} - box[a]);
    return e[0] * e[1] + e[2] * (e[0] + e[1]);
}

}  // namespace

Collapse::Collapse(const rt_host* host, const BinaryTree& tree, const Costs& costs)
    : tree_(tree), costs_(costs), choices_(tree.node_count) {
    for (size_t g = 0; g < tree.roots.size(); ++g) cut(g);
    // Small groups by the thousand: several to a task's turn would gain nothing, parallel_for hands out indices cheaply.
    rt::parallel_for(host, static_cast<rt_u32>(tasks_.size()), [&](rt_u32 t) {
        for (rt_u32 i = tasks_[t].end; i-- > tasks_[t].begin;) decide(i, scales_[t]);  // children stand behind their parents
    });
    for (size_t i = top_.size(); i-- > 0;) decide(top_[i].node, top_[i].scale);
}

// A subtree stands in one piece, the left child's part before the right one's, so where each ends need not be counted.
void Collapse::cut(size_t group) {
    const bvh2_node& root = tree_.nodes.data()[tree_.roots[group]];
    double longest = 0;
    for (int a = 0; a < 3; ++a) {
        double extent = double{root.box0[3 + a]} - root.box0[a];
        if (!is_nothing(root.child1))
            extent = double{std::max(root.box0[3 + a], root.box1[3 + a])} - std::min(root.box0[a], root.box1[a]);
        longest = std::max(longest, extent);
    }
    const double scale = longest > 0 ? 1 / longest : 0;
    std::vector<Span> open{{tree_.roots[group], tree_.end_of(group)}};
    while (!open.empty()) {
        const Span at = open.back();
        open.pop_back();
        if (at.end - at.begin <= kTaskNodes) {
            tasks_.push_back(at);
            scales_.push_back(scale);
            continue;
        }
        top_.push_back({at.begin, scale});
        const bvh2_node& node = tree_.nodes.data()[at.begin];
        const rt_u32 middle = is_leaf(node.child1) ? at.end : node.child1;
        if (middle < at.end) open.push_back({middle, at.end});  // taken after the left one, so tasks come in order
        if (at.begin + 1 < middle) open.push_back({at.begin + 1, middle});
    }
}

bool Collapse::is_above_tasks(rt_u32 binary) const {
    const auto after =
        std::upper_bound(tasks_.begin(), tasks_.end(), binary, [](rt_u32 b, const Span& s) { return b < s.begin; });
    return after == tasks_.begin() || binary >= std::prev(after)->end;
}

void Collapse::decide(rt_u32 binary, double scale) {
    const bvh2_node& node = tree_.nodes.data()[binary];
    Choice& choice = choices_.data()[binary];
    float cost[2][BVH8_WIDTH - 1];
    uint32_t count = 0;
    choice.first = RT_NONE;
    bool may_be_leaf = true;
    const Child both[2] = {left_of(node), right_of(node)};
    for (int side = 0; side < 2; ++side) {
        const auto [box, code] = both[side];
        if (is_leaf(code)) {
            const float as_leaf =
                is_nothing(code) ? 0.0f : static_cast<float>(half_area(box, scale) * costs_.primitive * BVH2_LEAF_COUNT(code));
            std::fill_n(cost[side], BVH8_WIDTH - 1, as_leaf);
            count += BVH2_LEAF_COUNT(code);
            if (!is_nothing(code)) choice.first = std::min(choice.first, BVH2_LEAF_FIRST(code));
        } else {
            const Choice& below = choices_.data()[code];
            std::copy_n(below.cost, BVH8_WIDTH - 1, cost[side]);
            count += below.count;
            may_be_leaf = may_be_leaf && below.count > 0;
            choice.first = std::min(choice.first, below.first);
        }
    }
    may_be_leaf = may_be_leaf && count > 0 && count <= costs_.max_leaf;
    choice.count = may_be_leaf ? static_cast<uint8_t>(count) : uint8_t{0};

    // The cheapest way to share `roots` between left and right.
    float shared[BVH8_WIDTH + 1];
    for (uint32_t roots = 2; roots <= BVH8_WIDTH; ++roots) {
        shared[roots] = INFINITY;
        for (uint32_t left = 1; left < roots; ++left) {
            const float sum = cost[0][left - 1] + cost[1][roots - left - 1];
            if (sum < shared[roots]) {
                shared[roots] = sum;
                choice.left[roots] = static_cast<uint8_t>(left);
            }
        }
    }
    const bool has_area = !is_nothing(node.child1);
    const double area = has_area ? half_area(node, scale) : half_area(node.box0, scale);
    const float as_node = static_cast<float>(area * costs_.node) + shared[BVH8_WIDTH];
    const float as_leaf = static_cast<float>(area * costs_.primitive * count);
    choice.is_leaf = may_be_leaf && as_leaf <= as_node;
    choice.cost[0] = choice.is_leaf ? as_leaf : as_node;
    for (uint32_t roots = 2; roots < BVH8_WIDTH; ++roots) {
        const bool better = shared[roots] < choice.cost[roots - 2];
        choice.cost[roots - 1] = better ? shared[roots] : choice.cost[roots - 2];
        if (!better) choice.left[roots] = 0;
    }
}

uint32_t Collapse::children(rt_u32 binary, Slot slots[BVH8_WIDTH]) const {
    const bvh2_node& node = tree_.nodes.data()[binary];
    const uint32_t left = choices_.data()[binary].left[BVH8_WIDTH];
    Slot* next = slots;
    gather(left_of(node), left, next);
    gather(right_of(node), BVH8_WIDTH - left, next);
    return static_cast<uint32_t>(next - slots);
}

void Collapse::gather(const Child& child, uint32_t roots, Slot*& next) const {
    if (is_leaf(child.code)) {
        if (!is_nothing(child.code))
            *next++ = {child.box, BVH8_MAKE_LEAF(BVH2_LEAF_FIRST(child.code), BVH2_LEAF_COUNT(child.code)), 0};
        return;
    }
    const Choice& choice = choices_.data()[child.code];
    while (roots > 1 && choice.left[roots] == 0) --roots;
    if (roots == 1) {
        *next++ = {child.box, choice.is_leaf ? BVH8_MAKE_LEAF(choice.first, rt_u32{choice.count}) : BVH8_NOTHING, child.code};
        return;
    }
    const bvh2_node& node = tree_.nodes.data()[child.code];
    gather(left_of(node), choice.left[roots], next);
    gather(right_of(node), roots - choice.left[roots], next);
}

}  // namespace bvh8
