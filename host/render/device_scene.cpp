#include "render/device_scene.hpp"

#include <cmath>

#include "base/error.hpp"

namespace clarity {
namespace {

std::string mebibytes(uint64_t bytes) {
    return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MiB";
}

// Read-only memory of the device with this content; at least something, since no device takes empty buffers.
cl::Buffer upload(Device& device, const char* what, const void* data, uint64_t bytes, uint64_t& total) {
    static const char nothing[256] = {};
    if (bytes == 0) {
        data = nothing;
        bytes = sizeof nothing;
    }
    const DeviceInfo& info = device.info();
    if (info.max_allocation_bytes && bytes > info.max_allocation_bytes)
        throw Error(Exit::failed, "the scene does not fit: its " + std::string(what) + " take " + mebibytes(bytes) + " and " +
                                      info.name + " allows " + mebibytes(info.max_allocation_bytes) + " in one piece");
    total += bytes;
    const bool shared = info.cpu && data != nothing;
    try {
        return cl::Buffer(device.context(), CL_MEM_READ_ONLY | (shared ? CL_MEM_USE_HOST_PTR : CL_MEM_COPY_HOST_PTR), bytes,
                          const_cast<void*>(data));
    } catch (const cl::Error& e) {
        throw Error(Exit::failed, "no room on " + info.name + " for the " + what + " (" + mebibytes(bytes) + ", with " +
                                      mebibytes(total) + " of " + mebibytes(info.global_bytes) +
                                      " in use by this scene): OpenCL error " + std::to_string(e.err()));
    }
}

template <class T>
cl::Buffer upload(Device& device, const char* what, const std::vector<T>& data, uint64_t& total) {
    return upload(device, what, data.data(), data.size() * sizeof(T), total);
}

// Normals of vertices in the space where their triangles stand: those of flattened meshes go by the inverse transpose, as those
// of instances do in the kernels, but for a factor that keeps their lengths near what they were, however large the scale.
std::vector<float> normals_as_placed(const Scene& scene, const BuildScene& build) {
    std::vector<float> normals = scene.normals;
    for (const uint32_t i : build.flattened) {
        const Instance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[instance.mesh];
        Affine inverse;
        if (!invert(instance.world_from_object, inverse)) continue;
        const Affine& m = inverse;
        const double volume = m[0] * (double(m[5]) * m[10] - double(m[6]) * m[9]) +
                              m[1] * (double(m[6]) * m[8] - double(m[4]) * m[10]) +
                              m[2] * (double(m[4]) * m[9] - double(m[5]) * m[8]);
        const double factor = 1 / std::cbrt(std::fabs(volume));
        for (size_t v = mesh.first_vertex; v < size_t(mesh.first_vertex) + mesh.vertex_count; ++v) {
            float* const n = &normals[3 * v];
            double turned[3];
            for (int k = 0; k < 3; ++k) turned[k] = double(m[k]) * n[0] + double(m[4 + k]) * n[1] + double(m[8 + k]) * n[2];
            for (int k = 0; k < 3; ++k) n[k] = static_cast<float>(factor * turned[k]);
        }
    }
    return normals;
}

}  // namespace

DeviceScene::DeviceScene(Device& device, std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> accel)
    : scene_(std::move(scene)), accel_(std::move(accel)) {
    for (const Material& material : scene_->materials) materials_.push_back(material.values);
    const BuildScene& build = accel_->scene;
    if (!scene_->normals.empty() || !scene_->uvs.empty()) {
        attributes_.resize(build.attribute_triangle.size());
        for (size_t i = 0; i < attributes_.size(); ++i)
            for (int c = 0; c < 3; ++c) attributes_[i].v[c] = scene_->triangles[3 * size_t(build.attribute_triangle[i]) + c];
    }
    const auto add = [&](cl::Buffer buffer) { before_lights_.push_back(std::move(buffer)); };
    add(upload(device, "leaves", accel_->leaves.data(), (accel_->leaf_count + kLeafPadding) * sizeof(rt_leaf), bytes_));
    add(upload(device, "instances", accel_->instances, bytes_));
    add(upload(device, "polygons", build.polygon_table, bytes_));
    add(upload(device, "polygon corners", build.polygon_corners, bytes_));
    add(upload(device, "planes", build.planes, bytes_));
    materials_at_ = before_lights_.size();
    add(upload(device, "materials", materials_, bytes_));
    add(upload(device, "triangles", attributes_, bytes_));
    const bool moved = !scene_->normals.empty() && !build.flattened.empty();
    if (moved) normals_ = normals_as_placed(*scene_, build);
    add(upload(device, "normals", moved ? normals_ : scene_->normals, bytes_));
    add(upload(device, "texture coordinates", scene_->uvs, bytes_));
    add(upload(device, "texture table", scene_->textures, bytes_));
    add(upload(device, "textures", scene_->texels, bytes_));
    const rt_accel& table = *accel_->plugin->accel;
    for (rt_u32 s = 0; s < table.slot_count; ++s)
        slots_.push_back(upload(device, table.slots[s].name, accel_->slots[s].memory.data(),
                                accel_->slots[s].count * table.slots[s].elem_bytes, bytes_));
}

void DeviceScene::bind(cl::Kernel& kernel, cl_uint first, const cl::Buffer& lights, const cl::Buffer* materials) const {
    for (size_t i = 0; i < before_lights_.size(); ++i)
        kernel.setArg(first++, materials && i == materials_at_ ? *materials : before_lights_[i]);
    kernel.setArg(first++, lights);
    for (const cl::Buffer& buffer : slots_) kernel.setArg(first++, buffer);
}

}  // namespace clarity
