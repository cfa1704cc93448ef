#include "binary_tree.hpp"

#include "builder.hpp"
#include "rt_plugin.hpp"

namespace bvh8 {
namespace {

// Stands between bvh2's builder and the host: what the builder writes stays here, but for the leaf order.
struct Tap {
    const rt_build_output* out;
    std::unique_ptr<bvh2::Scratch<bvh2_node>> nodes;
    rt_u32 node_count = 0;
    std::vector<rt_u32> roots;
};

struct Progress {
    const rt_host* host;
    float share;
};

}  // namespace

BinaryTree build_binary_tree(const rt_host* host, const rt_build_input& input, const rt_build_output* out,
                             const bvh2::Rules& rules, uint64_t primitive_count, float share) {
    Tap tap{out, nullptr, 0, std::vector<rt_u32>(input.group_count)};
    rt_build_output into{};
    into.struct_bytes = sizeof into;
    into.ctx = &tap;
    into.alloc = [](void* ctx, rt_u32, uint64_t count) -> void* {
        Tap& t = *static_cast<Tap*>(ctx);
        t.nodes = std::make_unique<bvh2::Scratch<bvh2_node>>(count);
        t.node_count = static_cast<rt_u32>(count);
        return t.nodes->data();
    };
    into.leaves = [](void* ctx, uint64_t count) {
        const rt_build_output* to = static_cast<Tap*>(ctx)->out;
        return to->leaves(to->ctx, count);
    };
    into.root = [](void* ctx, rt_u32 group, rt_u32 node) { static_cast<Tap*>(ctx)->roots[group] = node; };
    into.define = [](void*, const char*, rt_u32) {};
    into.stat = [](void*, const char*, double) {};

    Progress progress{host, share};
    const rt_host between{sizeof(rt_host),
                          &progress,
                          [](void* ctx, const char* why) {
                              const rt_host* h = static_cast<Progress*>(ctx)->host;
                              return h->fail(h->ctx, why);
                          },
                          [](void* ctx, int32_t level, const char* text) {
                              const rt_host* h = static_cast<Progress*>(ctx)->host;
                              h->log(h->ctx, level, text);
                          },
                          [](void* ctx, float fraction) {
                              const Progress& p = *static_cast<Progress*>(ctx);
                              return p.host->progress(p.host->ctx, fraction * p.share);
                          },
                          [](void* ctx, rt_u32 count, void (*body)(void*, rt_u32), void* user) {
                              const rt_host* h = static_cast<Progress*>(ctx)->host;
                              h->parallel_for(h->ctx, count, body, user);
                          }};
    bvh2::Builder(&between, input, rules, primitive_count).run(&into);
    return {std::move(*tap.nodes), tap.node_count, std::move(tap.roots)};
}

uint64_t binary_tree_bytes(uint64_t primitive_count) {
    return primitive_count * (bvh2::Builder::kBytesPerPrimitive + sizeof(bvh2_node));
}

}  // namespace bvh8
