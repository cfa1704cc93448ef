#include "moving/on_device/device_deformer.hpp"

#include <algorithm>
#include <cstring>
#include <map>

#include "device/cl_errors.hpp"
#include "scene/motion/deform.hpp"

namespace clarity {
namespace {

constexpr uint64_t kSerialVertices = 4096;  // of a chunk, where one work-item makes it

std::vector<rt_u32> deforming(const Motion& motion) {
    std::vector<rt_u32> meshes;
    for (const VertexFrames& frames : motion.frames) meshes.push_back(frames.mesh);
    for (const Morph& morph : motion.morphs) meshes.push_back(morph.mesh);
    for (const Skin& skin : motion.skins) meshes.push_back(skin.mesh);
    std::sort(meshes.begin(), meshes.end());
    meshes.erase(std::unique(meshes.begin(), meshes.end()), meshes.end());
    return meshes;
}

size_t count_vertices(const Scene& scene, const std::vector<rt_u32>& meshes) {
    size_t count = 0;
    for (const rt_u32 m : meshes) count += scene.meshes[m].vertex_count;
    return count;
}

}  // namespace

bool DeviceDeformer::fits(const Scene& rest, const DeviceInfo& device) {
    return deform_table_fits(rest, device.global_bytes, device.max_allocation_bytes);
}

DeviceDeformer::DeviceDeformer(const BuildKernels& kernels, std::shared_ptr<const Scene> rest)
    : kernels_(kernels), rest_(std::move(rest)) {
    const Motion& motion = rest_->motion;
    const DeformTable table(*rest_);
    place_of_mesh_ = table.place_of_mesh;
    for (size_t i = 0; i < table.meshes.size(); ++i) {
        const Mesh& mesh = rest_->meshes[table.meshes[i]];
        DeviceDeformation record{};
        record.first = table.first_number[i];
        record.count = mesh.vertex_count;
        record.first_vertex = mesh.first_vertex;
        records_.push_back(record);
    }
    wrap_cl_errors(kernels_.device(), "preparing a scene that deforms", [&] {
        first_share_ = records_.size() * sizeof(DeviceDeformation) / sizeof(double);
        first_bone_ = first_share_ + motion.morph_targets.size();
        first_dual_ = first_bone_ + 12 * motion.bones.size();
        numbers_.assign(first_dual_ + 12 * motion.bones.size(), 0);
        numbers_there_ = kernels_.buffer(numbers_.size() * sizeof(double));
        make_kernels(table);
        return 0;
    });
}

// Sends what poses do not change.
void DeviceDeformer::make_kernels(const DeformTable& table) {
    const auto there = [&](const auto& values) {
        const size_t bytes = values.size() * sizeof values[0];
        cl::Buffer buffer = kernels_.buffer(bytes);
        if (bytes > 0) kernels_.device().queue().enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes, values.data());
        return buffer;
    };
    const uint64_t each = kernels_.serial() ? kSerialVertices : kernels_.group();
    std::vector<rt_u32> chunks;
    for (rt_u32 i = 0; i < records_.size(); ++i)
        for (uint64_t v = 0; v < records_[i].count; v += each) chunks.insert(chunks.end(), {i, static_cast<rt_u32>(v)});
    chunks_ = chunks.size() / 2;
    const cl::Buffer chunks_there = there(chunks), rest_normals = there(table.normals);
    buffers_.push_back(chunks_there);
    const cl::Program program = kernels_.compile_file("deform.cl");
    const auto kernel = [&](const char* name, const std::vector<cl::Buffer>& more) {
        cl::Kernel made(program, name);
        made.setArg(0, numbers_there_);
        made.setArg(1, chunks_there);
        made.setArg(2, static_cast<cl_uint>(each));
        for (size_t i = 0; i < more.size(); ++i) made.setArg(static_cast<cl_uint>(3 + i), more[i]);
        buffers_.insert(buffers_.end(), more.begin(), more.end());
        return made;
    };
    std::vector<rt_u32> targets;
    std::vector<std::array<float, 3>> offsets, turns;
    for (const DeformTable::MorphEntry& entry : table.entries.items) {
        targets.push_back(entry.target);
        offsets.push_back(entry.offset);
        if (!table.normals.empty()) turns.push_back(entry.turn);
    }
    vertices_ = kernel("deform_vertices",
                       {there(table.positions), rest_normals, there(table.entries.first), there(targets), there(offsets),
                        there(turns), there(table.weights.first), there(table.weights.items), there(table.dual_shares)});
    cl_uint argument = 12;
    for (const size_t number : {first_share_, first_bone_, first_dual_, size_t(table.normals.empty() ? 0 : 1)})
        vertices_.setArg(argument++, static_cast<cl_uint>(number));
    if (rest_->motion.frames.empty()) return;
    frames_ = kernel("deform_frames", {there(rest_->motion.frame_positions)});
    if (!table.normals.empty())
        normals_ = kernel("deform_normals",
                          {rest_normals, there(table.around.first), there(table.around.items), there(table.corners)});
}

DeviceDeformer::~DeviceDeformer() {
    try {
        if (sent_()) sent_.wait();
    } catch (const cl::Error&) {  // the device is lost: nothing reads this memory any more
    }
}

// Only the meshes of this call act.
void DeviceDeformer::send_numbers(const std::vector<const Deformation*>& meshes) {
    const Motion& motion = rest_->motion;
    if (sent_()) sent_.wait();
    for (DeviceDeformation& record : records_) record.acts = 0;
    double* const shares = numbers_.data() + first_share_;
    std::map<rt_u32, const Deformation*> acting;
    for (const Deformation* d : meshes) acting[d->mesh] = d;
    for (const Morph& morph : motion.morphs)
        if (acting.count(morph.mesh)) std::fill_n(shares + morph.first_target, morph.target_count, 0.0);
    for (const auto& [mesh, d] : acting) {
        DeviceDeformation& record = records_[place_of_mesh_[mesh]];
        record.acts = 1;
        record.has_frames = d->frames != RT_NONE;
        if (d->frames != RT_NONE) {
            const uint64_t first = motion.frames[d->frames].first_position, numbers = 3 * uint64_t(record.count);
            record.before = first + d->frame_before * numbers;
            record.after = first + d->frame_after * numbers;
            record.frame_share = d->frame_share;
        }
        for (const Deformation::TargetShare& target : d->targets) shares[target.target] = target.share;
        record.skin = RT_NONE;
        if (d->skin == RT_NONE) continue;
        const Skin& skin = motion.skins[d->skin];
        record.skin = skin.method;
        record.first_bone = skin.first_bone;
        std::copy(d->unweighted.begin(), d->unweighted.end(), record.unweighted);
        for (size_t b = 0; b < d->bones.size(); ++b) {
            const size_t at = 12 * (skin.first_bone + b);
            std::copy(d->bones[b].begin(), d->bones[b].end(), &numbers_[first_bone_ + at]);
            if (skin.method == RT_SKIN_LINEAR) continue;
            const DualQuaternion dual = dual_quaternion(d->bones[b]);
            double* const to = &numbers_[first_dual_ + at];
            std::copy(dual.real.begin(), dual.real.end(), to);
            std::copy(dual.dual.begin(), dual.dual.end(), to + 4);
            std::copy(dual.scale.begin(), dual.scale.end(), to + 8);
        }
    }
    std::memcpy(numbers_.data(), records_.data(), records_.size() * sizeof(DeviceDeformation));
    kernels_.device().queue().enqueueWriteBuffer(numbers_there_, CL_FALSE, 0, numbers_.size() * sizeof(double), numbers_.data(),
                                                 nullptr, &sent_);
}

void DeviceDeformer::deform(const std::vector<const Deformation*>& meshes, const cl::Buffer& positions,
                            const cl::Buffer& normals) {
    if (meshes.empty() || chunks_ == 0) return;
    send_numbers(meshes);
    if (frames_()) {
        frames_.setArg(4, positions);
        kernels_.launch(frames_, chunks_);
    }
    if (normals_()) {
        normals_.setArg(7, positions);
        normals_.setArg(8, normals);
        kernels_.launch(normals_, chunks_);
    }
    vertices_.setArg(16, positions);
    vertices_.setArg(17, normals);
    kernels_.launch(vertices_, chunks_);
}

bool deform_table_fits(const Scene& rest, uint64_t global, uint64_t largest) {
    const Motion& motion = rest.motion;
    uint64_t triangles = 0;
    for (const VertexFrames& frames : motion.frames) triangles += rest.meshes[frames.mesh].triangle_count;
    const uint64_t pieces[] = {4 * motion.frame_positions.size(), 12 * motion.morph_vertices.size(), 8 * motion.weights.size(),
                               12 * count_vertices(rest, deforming(motion)), 12 * triangles};
    uint64_t all = 0;
    for (const uint64_t piece : pieces) all += 2 * piece;
    return motion.weights.size() < RT_NONE && motion.morph_vertices.size() < RT_NONE && 3 * triangles < RT_NONE &&
           all <= global / 4 && *std::max_element(std::begin(pieces), std::end(pieces)) <= largest;
}

DeformTable::DeformTable(const Scene& rest)
    : meshes(deforming(rest.motion)),
      place_of_mesh(rest.meshes.size(), RT_NONE),
      vertices(count_vertices(rest, meshes)),
      dual_shares(vertices, 0),
      entries(vertices),
      weights(vertices),
      around(vertices) {
    size_t first = 0;
    for (const rt_u32 m : meshes) {
        const Mesh& mesh = rest.meshes[m];
        place_of_mesh[m] = static_cast<rt_u32>(first_number.size());
        first_number.push_back(static_cast<rt_u32>(first));
        first += mesh.vertex_count;
        const StoredVertices stored = stored_vertices(rest, m);
        const size_t numbers = 3 * size_t(mesh.vertex_count);
        positions.insert(positions.end(), stored.positions, stored.positions + numbers);
        if (stored.normals) normals.insert(normals.end(), stored.normals, stored.normals + numbers);
    }
    list_morphs(rest);
    list_weights(rest);
    list_triangles(rest);
}

void DeformTable::list_morphs(const Scene& rest) {
    const Motion& motion = rest.motion;
    const auto each = [&](const auto& call) {
        for (const Morph& morph : motion.morphs)
            for (rt_u32 t = morph.first_target; t < morph.first_target + morph.target_count; ++t) {
                const MorphTarget& target = motion.morph_targets[t];
                for (uint64_t i = 0; i < target.count; ++i)
                    call(first_of(morph.mesh) + motion.morph_vertices[target.first + i], t, i);
            }
    };
    each([&](size_t number, rt_u32, uint64_t) { entries.count(number); });
    entries.end_count();
    each([&](size_t number, rt_u32 t, uint64_t i) {
        const MorphTarget& target = motion.morph_targets[t];
        MorphEntry& entry = entries.add(number);
        entry.target = t;
        std::copy_n(&motion.morph_positions[3 * (target.first + i)], 3, entry.offset.begin());
        if (target.has_normals) std::copy_n(&motion.morph_normals[target.first_normal + 3 * i], 3, entry.turn.begin());
    });
}

void DeformTable::list_weights(const Scene& rest) {
    const Motion& motion = rest.motion;
    const auto each = [&](const auto& call) {
        for (const Skin& skin : motion.skins)
            for (uint64_t w = skin.first_weight; w < skin.first_weight + skin.weight_count; ++w)
                call(first_of(skin.mesh) + motion.weights[w].vertex, motion.weights[w]);
    };
    each([&](size_t number, const rt_weight&) { weights.count(number); });
    weights.end_count();
    each([&](size_t number, const rt_weight& w) { weights.add(number) = {w.bone, w.weight}; });
    for (const Skin& skin : motion.skins)
        if (skin.method == RT_SKIN_BLENDED)
            std::copy_n(&motion.shares[skin.first_share], rest.meshes[skin.mesh].vertex_count,
                        &dual_shares[first_of(skin.mesh)]);
}

void DeformTable::list_triangles(const Scene& rest) {
    for (const VertexFrames& frames : rest.motion.frames) {
        const Mesh& mesh = rest.meshes[frames.mesh];
        for (size_t i = 3 * size_t(mesh.first_triangle); i < 3 * (size_t(mesh.first_triangle) + mesh.triangle_count); ++i) {
            corners.push_back(rest.triangles[i] - mesh.first_vertex);
            around.count(first_of(frames.mesh) + corners.back());
        }
    }
    around.end_count();
    size_t i = 0;
    for (const VertexFrames& frames : rest.motion.frames)
        for (const size_t end = i + 3 * size_t(rest.meshes[frames.mesh].triangle_count); i < end; ++i)
            around.add(first_of(frames.mesh) + corners[i]) = static_cast<rt_u32>(i / 3);
}

}  // namespace clarity
