#include "render/moving/on_device/deform_table.hpp"

#include <algorithm>

#include "scene/motion/deform.hpp"

namespace clarity {
namespace {

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
