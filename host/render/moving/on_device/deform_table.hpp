// deform_table.hpp -- what poses never change of the meshes that deform, listed by vertex, for kernels that make one vertex
// each (cl/build/deform.cl).
#pragma once
#include <array>
#include <vector>

#include "scene/scene.hpp"

namespace clarity {

// Lists of items, one for each vertex: those of vertex v are items[first[v]] to items[first[v + 1]], in the order in which they
// were added. All are counted first, then added.
template <class Item>
class ListsByVertex {
 public:
    std::vector<rt_u32> first;
    std::vector<Item> items;

    explicit ListsByVertex(size_t vertices) : first(vertices + 1, 0) {}
    void count(size_t v) { ++first[v + 1]; }
    void end_count() {
        for (size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
        items.resize(first.back());
        next_.assign(first.begin(), first.end() - 1);
    }
    Item& add(size_t v) { return items[next_[v]++]; }

 private:
    std::vector<rt_u32> next_;
};

// "Number" of a vertex: among those of all meshes that deform, in the order of meshes.
struct DeformTable {
    struct BoneWeight {
        rt_u32 bone = 0;  // within the skin
        float weight = 0;
    };
    struct MorphEntry {
        rt_u32 target = 0;  // of Motion::morph_targets
        std::array<float, 3> offset{}, turn{};
    };

    // rest: at rest.
    explicit DeformTable(const Scene& rest);

    std::vector<rt_u32> meshes;         // that have frames, morphs or a skin; ascending
    std::vector<rt_u32> first_number;   // of each of them
    std::vector<rt_u32> place_of_mesh;  // of each mesh of the scene: its place among those above; RT_NONE
    size_t vertices = 0;
    std::vector<float> positions, normals;  // by number, as stored, 3 each; no normals if the scene has none
    std::vector<float> dual_shares;         // by number, of skins that are blended
    ListsByVertex<MorphEntry> entries;      // ascending by target
    ListsByVertex<BoneWeight> weights;
    ListsByVertex<rt_u32> around;  // the triangles at a vertex, of meshes with frames; ascending
    std::vector<rt_u32> corners;   // of those triangles, 3 vertices each, counted within their mesh

 private:
    void list_morphs(const Scene& rest);
    void list_weights(const Scene& rest);
    void list_triangles(const Scene& rest);
    size_t first_of(rt_u32 mesh) const { return first_number[place_of_mesh[mesh]]; }
};

// Whether the memory of a device is enough for it and the vertex frames: `global` bytes, a quarter of which it may take, in
// buffers of at most `largest` bytes.
bool deform_table_fits(const Scene& rest, uint64_t global, uint64_t largest);

}  // namespace clarity
