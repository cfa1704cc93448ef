#include "launch/device_scene.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/error.hpp"
#include "base/timeline.hpp"
#include "kernels/scene_buffers.hpp"
#include "scene/motion/matrix.hpp"
#include "structures/memory_plan.hpp"

namespace clarity {
namespace {

// Names of buffers as arguments of kernels. In the constructor they are those of scene_buffers.hpp.
constexpr const char *kLeaves = "ctx_leaves", *kInstances = "ctx_instances", *kPolygons = "ctx_polygons",
                     *kPolygonCorners = "ctx_polygon_corners", *kMaterials = "ctx_materials", *kLayers = "ctx_layers",
                     *kTriangles = "ctx_triangles", *kNormals = "ctx_normals";

constexpr uint64_t kPiece = 256u << 20;  // bytes uploaded between two progress reports

// The content of a buffer.
struct Bytes {
    uint64_t count;
    const void* data;
};

template <class Array>
Bytes bytes_of(const Array& data) {
    return {data.size() * sizeof(typename Array::value_type), data.data()};
}

Bytes leaves_of(const AccelData& accel) {
    return {(accel.leaf_count + kLeafPadding) * sizeof(rt_packed_prim), accel.leaves.data()};
}

// A buffer to be made.
struct Content {
    std::string argument;
    MemoryPiece piece;
    const void* data;
};

// bytes: of the buffer that the table calls `name`.
Content content(const std::string& name, const Bytes& bytes) {
    for (const SceneBuffer& buffer : kSceneBuffers)
        if (name == buffer.name) return {"ctx_" + name, {buffer.what, bytes.count}, bytes.data};
    throw std::logic_error("the scene buffer " + name + " is not in scene_buffers.hpp");
}

// Makes read-only buffers. On a CPU they are the host's own memory. On other devices they are filled piece by piece, because a
// driver that gets everything at once may first copy all of it on the host.
class Uploader {
 public:
    Uploader(Device& device, const std::vector<Content>& contents, Progress& progress)
        : device_(device), progress_(progress), queue_(device.context(), device.info().cl_device) {
        for (const Content& content : contents) total_ += content.piece.bytes;
    }

    cl::Buffer upload(const Content& content) {
        static const char nothing[256] = {};  // OpenCL does not allow empty buffers
        const uint64_t bytes = content.piece.bytes;
        try {
            if (bytes == 0)
                return cl::Buffer(device_.context(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, sizeof nothing,
                                  const_cast<char*>(nothing));
            if (device_.info().cpu)
                return cl::Buffer(device_.context(), CL_MEM_READ_ONLY | CL_MEM_USE_HOST_PTR, bytes,
                                  const_cast<void*>(content.data));
            cl::Buffer buffer(device_.context(), CL_MEM_READ_ONLY, bytes);
            for (uint64_t at = 0; at < bytes; at += kPiece) {
                const uint64_t count = std::min(kPiece, bytes - at);
                queue_.enqueueWriteBuffer(buffer, CL_TRUE, at, count, static_cast<const char*>(content.data) + at);
                done_ += count;
                if (!progress_.report(static_cast<float>(double(done_) / double(total_)))) throw Cancelled();
            }
            return buffer;
        } catch (const cl::Error& e) {
            throw Error(Exit::failed, "no room on " + device_.info().name + " for the " + content.piece.what + " (" +
                                          memory_text(bytes) + " of " + memory_text(total_) +
                                          " that the scene needs; the device has " + memory_text(device_.info().global_bytes) +
                                          " in all, shared with other programs): OpenCL error " + std::to_string(e.err()) +
                                          "; close other programs that use the device, or use a scene of fewer triangles");
        }
    }

    uint64_t total() const { return total_; }

 private:
    Device& device_;
    Progress& progress_;
    Queue queue_;  // its own, so that frames continue in the device's queue
    uint64_t total_ = 0, done_ = 0;
};

// Returns the vertex normals in the space of their triangles. Normals of flattened meshes are transformed by the inverse
// transpose, as kernels do for instances. A factor keeps their lengths near the original for any scale. Each mesh is
// transformed once: group_meshes() in build_scene.cpp flattens a mesh of several instances only where one has no volume, and
// that has no inverse.
std::vector<float> normals_as_placed(const Scene& scene, const BuildScene& build) {
    std::vector<float> normals = scene.normals.copy();
    std::vector<bool> done(scene.meshes.size());
    for (const uint32_t i : build.flattened) {
        const Instance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[instance.mesh];
        Affine inverse;
        if (!invert(instance.world_from_object, inverse)) continue;
        if (done[instance.mesh]) throw std::logic_error("the normals of a mesh would be transformed twice");
        done[instance.mesh] = true;
        const Affine& m = inverse;
        const double factor = 1 / std::cbrt(std::fabs(determinant(to_matrix(m))));
        for (size_t v = mesh.first_vertex; v < size_t(mesh.first_vertex) + mesh.vertex_count; ++v) {
            float* const n = &normals[3 * v];
            double turned[3];
            for (int k = 0; k < 3; ++k) turned[k] = double(m[k]) * n[0] + double(m[4 + k]) * n[1] + double(m[8 + k]) * n[2];
            for (int k = 0; k < 3; ++k) n[k] = static_cast<float>(factor * turned[k]);
        }
    }
    return normals;
}

// The textures, and behind them those of their smaller pictures.
std::vector<rt_texture> with_smaller_ones(const std::vector<rt_texture>& textures) {
    std::vector<rt_texture> all = textures;
    for (size_t i = 0; i < textures.size(); ++i) {
        all[i].smaller = static_cast<rt_u32>(all.size());
        rt_texture at = textures[i];
        for (rt_u32 level = 0; level < textures[i].levels; ++level) {
            at = smaller_picture(at);
            at.levels = 0;
            all.push_back(at);
        }
    }
    return all;
}

void add_slots(const AccelData& accel, std::vector<Content>& contents) {
    const rt_accel& table = *accel.layout->accel;
    for (rt_u32 s = 0; s < table.slot_count; ++s)
        if (!(table.slots[s].flags & RT_SLOT_HOST_ONLY))
            contents.push_back({std::string("ctx_") + table.slots[s].name,
                                {table.slots[s].name, accel.slots[s].count * table.slots[s].elem_bytes},
                                accel.slots[s].memory.data()});
}

}  // namespace

DeviceScene::DeviceScene(Device& device, std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> accel,
                         Progress& progress)
    : loss_(device.loss()), scene_(std::move(scene)), accel_(std::move(accel)) {
    const timeline::Scope span("copy", "bring the scene to the device");
    for (const Material& material : scene_->materials) {
        materials_.push_back(material.values);
        layers_.push_back(material.values.layers);
        if (!scene_->maps.empty()) material_maps_.insert(material_maps_.end(), material.maps.begin(), material.maps.end());
    }
    const BuildScene& build = accel_->scene;
    if (scene_->has_attributes()) {
        attributes_.resize(build.attribute_triangle.size());
        for (size_t i = 0; i < attributes_.size(); ++i)
            for (int c = 0; c < 3; ++c) attributes_[i].v[c] = scene_->triangles[3 * size_t(build.attribute_triangle[i]) + c];
    }
    if (!scene_->tangents.empty())
        for (const uint32_t triangle : build.attribute_triangle)
            tangents_.insert(tangents_.end(), &scene_->tangents[3 * size_t(triangle)],
                             &scene_->tangents[3 * size_t(triangle)] + 3);
    textures_ = with_smaller_ones(scene_->textures);
    has_triangles_ = !attributes_.empty();
    const bool moved = !scene_->normals.empty() && !build.flattened.empty();
    if (moved) normals_ = normals_as_placed(*scene_, build);
    std::vector<Content> contents = {
        content("leaves", leaves_of(*accel_)),
        content("instances", bytes_of(accel_->instances)),
        content("polygons", bytes_of(build.polygon_table)),
        content("polygon_corners", bytes_of(build.polygon_corners)),
        content("planes", bytes_of(build.planes)),
        content("materials", bytes_of(materials_)),
        content("layers", bytes_of(layers_)),
        content("triangles", bytes_of(attributes_)),
        content("normals", moved ? bytes_of(normals_) : bytes_of(scene_->normals)),
        content("uvs", bytes_of(scene_->uvs)),
        content("textures", bytes_of(textures_)),
        content("texels", bytes_of(scene_->texels)),
    };
    if (!scene_->maps.empty()) {
        contents.push_back(content("maps", bytes_of(scene_->maps)));
        contents.push_back(content("material_maps", bytes_of(material_maps_)));
        if (!scene_->uvs2.empty()) contents.push_back(content("uvs2", bytes_of(scene_->uvs2)));
    }
    if (!scene_->tangents.empty()) contents.push_back(content("tangents", bytes_of(tangents_)));
    if (!scene_->colors.empty()) contents.push_back(content("colors", bytes_of(scene_->colors)));
    if (!build.shapes.empty()) {
        contents.push_back(content("shapes", bytes_of(build.shapes)));
        contents.push_back(content("shape_numbers", bytes_of(scene_->shape_numbers)));
    }
    const size_t first_slot = contents.size();
    add_slots(*accel_, contents);
    std::vector<MemoryPiece> pieces;
    for (const Content& content : contents) pieces.push_back(content.piece);
    check_fits(pieces, device.info(), std::to_string(accel_->leaf_count) + " primitives in " + accel_->plugin->id);

    Uploader uploader(device, contents, progress);
    for (size_t i = 0; i < first_slot; ++i) buffers_[contents[i].argument] = uploader.upload(contents[i]);
    for (size_t i = first_slot; i < contents.size(); ++i) {
        slots_.push_back(uploader.upload(contents[i]));
        slot_arguments_.push_back(contents[i].argument);
    }
    bytes_ = uploader.total();
    if (device.info().cpu) return;
    // Only the upload needed these copies.
    attributes_ = {};
    normals_ = {};
    tangents_ = {};
    textures_ = {};
    material_maps_ = {};
}

DeviceScene::DeviceScene(const DeviceScene& at_rest, Moving moving)
    : loss_(at_rest.loss_),
      still_(at_rest.shared_from_this()),  // on a CPU it owns the memory of shared buffers
      buffers_(at_rest.buffers_),
      slots_(std::move(moving.slots)),
      slot_arguments_(at_rest.slot_arguments_),
      has_triangles_(at_rest.has_triangles_),
      bytes_(at_rest.bytes_) {
    buffers_[kLeaves] = std::move(moving.leaves);
    buffers_[kInstances] = std::move(moving.instances);
    buffers_[kNormals] = std::move(moving.normals);
    bounds_ = std::move(moving.bounds);
    roots_ = std::move(moving.roots);
}

// A kernel that still runs reads the buffers, and on a CPU the memory of `accel_` and `scene_`.
DeviceScene::~DeviceScene() {
    if (!loss_->stuck()) return;
    struct Kept {
        std::map<std::string, cl::Buffer> buffers;
        std::vector<cl::Buffer> more;
        std::shared_ptr<const Scene> scene;
        std::shared_ptr<const AccelData> accel;
    };
    auto kept = std::make_shared<Kept>(Kept{std::move(buffers_), std::move(slots_), std::move(scene_), std::move(accel_)});
    kept->more.insert(kept->more.end(), {bounds_, roots_});
    never_release(std::move(kept));
}

DeviceScene::Fixed DeviceScene::fixed() const {
    return {buffers_.at(kPolygons), buffers_.at(kPolygonCorners), buffers_.at(kTriangles)};
}

DeviceScene::Moving DeviceScene::moving() const {
    return {buffers_.at(kLeaves), buffers_.at(kInstances), buffers_.at(kNormals), slots_, bounds_, roots_};
}

void DeviceScene::complete(Queue& queue, const cl::Buffer& frames, size_t count) const {
    if (!bounds_()) return;
    for (size_t i = 0; i < count; ++i) {
        const size_t frame = i * sizeof(rt_frame);
        queue.enqueueCopyBuffer(bounds_, frames, 0, frame + offsetof(rt_frame, bounds), sizeof(rt_frame::bounds));
        queue.enqueueCopyBuffer(roots_, frames, 0, frame + offsetof(rt_frame, root), sizeof(rt_frame::root));
    }
}

DeviceScene::DeviceScene(Device& device, std::shared_ptr<const DeviceScene> still, std::shared_ptr<const AccelData> accel,
                         const std::vector<PosedMesh>& deformed, Progress& progress)
    : loss_(device.loss()),
      still_(std::move(still)),
      scene_(still_->scene_),
      accel_(std::move(accel)),
      buffers_(still_->buffers_),
      slot_arguments_(still_->slot_arguments_),
      has_triangles_(still_->has_triangles_),
      bytes_(still_->bytes_) {
    std::vector<Content> contents = {content("leaves", leaves_of(*accel_)), content("instances", bytes_of(accel_->instances))};
    add_slots(*accel_, contents);
    Uploader uploader(device, contents, progress);
    buffers_[kLeaves] = uploader.upload(contents[0]);
    buffers_[kInstances] = uploader.upload(contents[1]);
    for (size_t i = 2; i < contents.size(); ++i) slots_.push_back(uploader.upload(contents[i]));
    if (scene_->normals.empty() || deformed.empty()) return;
    // A copy on the device, into which the normals of the deformed meshes are written.
    const size_t normal_bytes = scene_->normals.size() * sizeof(float);
    const cl::Buffer normals(device.context(), CL_MEM_READ_ONLY, normal_bytes);
    Queue queue(device.context(), device.info().cl_device);
    queue.enqueueCopyBuffer(buffers_[kNormals], normals, 0, 0, normal_bytes);
    for (const PosedMesh& mesh : deformed)
        if (!mesh.normals.empty())
            queue.enqueueWriteBuffer(normals, CL_FALSE, 3 * sizeof(float) * size_t(scene_->meshes[mesh.mesh].first_vertex),
                                     mesh.normals.size() * sizeof(float), mesh.normals.data());
    queue.finish();
    buffers_[kNormals] = normals;
}

void DeviceScene::bind(KernelArguments& kernel, const cl::Buffer& lights, const cl::Buffer* materials,
                       const cl::Buffer* layers) const {
    for (const auto& [argument, buffer] : buffers_) {
        if (argument != kLayers)
            kernel.set(argument, materials && argument == kMaterials ? *materials : buffer);
        else if (kernel.has(argument))
            kernel.set(argument, layers ? *layers : buffer);
    }
    kernel.set("ctx_lights", lights);
    for (size_t i = 0; i < slots_.size(); ++i) kernel.set(slot_arguments_[i], slots_[i]);
}

}  // namespace clarity
