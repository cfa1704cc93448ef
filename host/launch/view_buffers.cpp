#include "launch/view_buffers.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/error.hpp"
#include "launch/emitters/emitter_table.hpp"
#include "scene/sky_kinds.hpp"

namespace clarity {
namespace {

void check_materials(const Scene& scene, const std::vector<MaterialValues>& materials) {
    if (materials.size() != scene.materials.size())
        throw Error(Exit::failed, "the view has " + std::to_string(materials.size()) + " materials and the scene has " +
                                      std::to_string(scene.materials.size()) + ": the view needs one for each, or none");
    for (size_t i = 0; i < materials.size(); ++i)
        if (materials[i].texture != RT_NONE && materials[i].texture >= scene.textures.size())
            throw Error(Exit::failed, "material " + std::to_string(i) + " of the view names texture " +
                                          std::to_string(materials[i].texture) + " and the scene has " +
                                          std::to_string(scene.textures.size()));
}

template <class T>
bool is_as(const T& a, const T& b) {
    return a == b;
}
bool is_as(const SkyValues& a, const SkyValues& b) {
    return same_sky(a, b);
}
bool is_as(const SharedArray<float>& a, const SharedArray<float>& b) {
    return a.shares(b);
}
bool is_as(const std::weak_ptr<const AccelData>& a, const std::shared_ptr<const AccelData>& b) {
    return a.lock() == b;
}
template <class T>
bool is_as(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}
// Of each material the map of its emission.
bool is_as(const std::vector<rt_u32>& a, const std::vector<Material>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](rt_u32 map, const Material& material) { return map == material.maps[RT_MAP_EMISSION]; });
}
template <class T, class Now>
void take(T& was, const Now& now) {
    was = now;
}
void take(std::vector<rt_u32>& was, const std::vector<Material>& now) {
    was.clear();
    for (const Material& material : now) was.push_back(material.maps[RT_MAP_EMISSION]);
}

}  // namespace

void ViewBuffers::write(Queue& queue, const Scene& scene, const DeviceScene& on_device, const std::vector<rt_frame>& frames,
                        const View& view, const std::vector<rt_u32>& rows) {
    own_materials_ = !view.materials.empty();
    if (own_materials_) check_materials(scene, view.materials);
    const size_t frame_bytes = frames.size() * sizeof(rt_frame), row_bytes = rows.size() * sizeof(rt_u32);
    frames_and_rows_.resize(frame_bytes + row_bytes);
    std::memcpy(frames_and_rows_.data(), frames.data(), frame_bytes);
    if (row_bytes > 0) std::memcpy(frames_and_rows_.data() + frame_bytes, rows.data(), row_bytes);
    frame_.write(queue, frames_and_rows_.data(), frames_and_rows_.size());
    on_device.complete(queue, frame_.get(), frames.size());
    lights_.write(queue, view.lights.data(), view.lights.size() * sizeof(rt_light));
    if (!own_materials_) return;
    plain_materials_.assign(view.materials.begin(), view.materials.end());
    for (size_t i = 0; i < plain_materials_.size(); ++i) plain_materials_[i].texture = scene.materials[i].values.texture;
    material_layers_.clear();
    for (const MaterialValues& material : view.materials) material_layers_.push_back(material.layers);
    materials_.write(queue, plain_materials_.data(), plain_materials_.size() * sizeof(rt_material));
    layers_.write(queue, material_layers_.data(), material_layers_.size() * sizeof(rt_layers));
}

void ViewBuffers::write_emitters(Queue& queue, const Scene& scene, const std::shared_ptr<const AccelData>& accel,
                                 const View& view, const Settings& settings, const DeviceScene* moved) {
    EmittersOf& of = emitters_of_;
    static_assert(has_member_count<EmittersOf, 9>, "each is compared and kept here");
    const bool tree = has_light_tree(settings);
    bool same = std::exchange(has_emitters_, false);
    const auto keep = [&](auto& was, const auto& now) {
        if (is_as(was, now)) return;
        take(was, now);
        same = false;
    };
    keep(of.accel, accel), keep(of.lights, view.lights), keep(of.materials, view.materials);
    keep(of.background, view.background), keep(of.sky, sky_of(scene, view)), keep(of.sky_texels, scene.sky.texels);
    keep(of.maps, scene.maps), keep(of.emission_maps, scene.materials), keep(of.tree, tree);
    if (same) {
        has_emitters_ = true;
        return;
    }
    const auto upload = [&](UploadedBuffer& to, const auto& from) {
        static const rt_emitter nothing{};  // kernels get no empty buffers
        if (from.empty())
            to.write(queue, &nothing, sizeof nothing);
        else
            to.write(queue, from.data(), from.size() * sizeof from[0]);
    };
    if (!sky_of_.shares(scene.sky.texels) || !sky_texels_.get()()) {
        sky_of_ = scene.sky.texels;
        sky_ = make_sky_table(scene.sky);
        upload(sky_texels_, sky_.halves);
        std::vector<uint16_t>().swap(sky_.halves);
        upload(sky_picks_, sky_.picks);
    }
    MovedPrims prims;
    if (moved && !has_emitting_surfaces(scene, view)) moved = nullptr;
    if (moved) {
        const auto read = [&](const cl::Buffer& from, auto& to, size_t count) {
            to.resize(count);
            if (count > 0) queue.enqueueReadBuffer(from, CL_TRUE, 0, count * sizeof to[0], to.data());
        };
        const DeviceScene::Moving buffers = moved->moving();
        read(buffers.leaves, prims.leaves, accel->leaf_count);
        read(buffers.instances, prims.instances, accel->instances.size());
    }
    const EmitterTable table = make_emitter_table(scene, *accel, view, sky_, moved ? &prims : nullptr, tree);
    upload(emitters_, table.emitters);
    upload(emitter_runs_, table.runs);
    if (tree) upload(light_nodes_, table.nodes);
    lighting_.write(queue, &table.lighting, sizeof table.lighting);
    has_emitters_ = true;
}

void UploadedBuffer::write(Queue& queue, const void* data, size_t bytes) {
    const cl::Buffer before = buffer_.get();
    const cl::Buffer& to = buffer_.fit(queue.getInfo<CL_QUEUE_CONTEXT>(), bytes);
    const bool same =
        to() == before() && written_.size() == bytes && (bytes == 0 || std::memcmp(written_.data(), data, bytes) == 0);
    if (same || bytes == 0) return;
    if (on_its_way_()) on_its_way_.wait();
    const auto* begin = static_cast<const unsigned char*>(data);
    written_.assign(begin, begin + bytes);
    try {
        queue.enqueueWriteBuffer(to, CL_FALSE, 0, bytes, written_.data(), nullptr, &on_its_way_);
    } catch (const cl::Error&) {
        written_.clear();
        throw;
    }
}

UploadedBuffer::~UploadedBuffer() {
    try {
        if (on_its_way_()) on_its_way_.wait();
    } catch (const cl::Error&) {  // the device is lost: nothing reads this memory any more
    }
}

void ViewBuffers::bind(const DeviceScene& scene, KernelArguments& kernel) const {
    kernel.set("frame", frame_.get());
    scene.bind(kernel, lights_.get(), own_materials_ ? &materials_.get() : nullptr, own_materials_ ? &layers_.get() : nullptr);
    if (!kernel.has("ctx_emitters")) return;
    kernel.set("ctx_emitters", emitters_.get())
        .set("ctx_emitter_runs", emitter_runs_.get())
        .set("ctx_lighting", lighting_.get());
    if (kernel.has("ctx_light_nodes")) kernel.set("ctx_light_nodes", light_nodes_.get());
    kernel.set("ctx_sky_texels", sky_texels_.get()).set("ctx_sky_picks", sky_picks_.get());
}

}  // namespace clarity
