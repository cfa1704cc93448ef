// device_deformer.hpp -- makes the vertices of meshes that deform on a device: what deformed() of scene/motion/deform.hpp makes
// on the host, to the last bit.
//
// What no pose changes is sent once: vertex frames, morph targets, weights of bones. A pose is one small command: matrices of
// bones, shares of targets, numbers of frames.
//
// Memory on the device: 24 B a vertex that deforms and 12 B for each of its frames, 28 B for each vertex of a morph target, 8 B
// for each weight of a bone; of meshes with frames also 24 B a triangle.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"
#include "structures/on_device/build_kernels.hpp"

namespace clarity {

// What moves one mesh, as kernels read it: rt_deformation of deform.cl, which explains it.
struct DeviceDeformation {
    uint64_t before, after;
    double frame_share;
    double unweighted[12];
    uint32_t first, count, first_vertex, first_bone, has_frames, skin, acts, pad;
};
static_assert(sizeof(DeviceDeformation) == 19 * sizeof(double));

struct DeformTable;

// Used from one thread at a time. Throws cl::Error besides what is named.
class DeviceDeformer {
 public:
    // rest: the scene at rest, with its motion. kernels: of a device with double precision; must outlive this object. Throws
    // Error(kernel_build_failed), and Error(failed) if memory is missing.
    DeviceDeformer(const BuildKernels& kernels, std::shared_ptr<const Scene> rest);
    ~DeviceDeformer();
    DeviceDeformer(const DeviceDeformer&) = delete;
    DeviceDeformer& operator=(const DeviceDeformer&) = delete;

    // Whether the memory of a device is enough: for a quarter of it, in pieces that it allows.
    static bool fits(const Scene& rest, const DeviceInfo& device);

    // Enqueues kernels that write the vertices of some meshes into those of the whole scene. normals: unused if the scene has
    // none. Waits only for the commands of an earlier call that send numbers.
    void deform(const std::vector<const Deformation*>& meshes, const cl::Buffer& positions, const cl::Buffer& normals);

 private:
    void make_kernels(const DeformTable& table);
    void send_numbers(const std::vector<const Deformation*>& meshes);

    const BuildKernels& kernels_;
    const std::shared_ptr<const Scene> rest_;
    std::vector<rt_u32> place_of_mesh_;       // of each mesh: which of records_; RT_NONE: it does not deform
    std::vector<DeviceDeformation> records_;  // of the meshes that deform
    size_t chunks_ = 0;                       // work-groups
    cl::Kernel frames_, normals_, vertices_;  // of deform.cl; null where the scene has no frames
    std::vector<cl::Buffer> buffers_;         // what they read; kernels do not own their arguments

    // What a pose sends: records_, shares of targets, bones as matrices, bones as dual quaternions.
    size_t first_share_ = 0, first_bone_ = 0, first_dual_ = 0;
    std::vector<double> numbers_;  // the device may read it until sent_
    cl::Buffer numbers_there_;
    cl::Event sent_;
};

// What poses never change of the meshes that deform, listed by vertex, for kernels that make one vertex
// each (cl/build/deform.cl).

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
