#include "scene/motion/deform.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel_for.hpp"

namespace clarity {
namespace {

struct Parts {
    const VertexFrames* frames = nullptr;
    std::vector<rt_u32> morphs;  // indices
    const Skin* skin = nullptr;
};

std::map<rt_u32, Parts> parts_by_mesh(const Motion& motion) {
    std::map<rt_u32, Parts> parts;
    for (const VertexFrames& frames : motion.frames) parts[frames.mesh].frames = &frames;
    for (size_t i = 0; i < motion.morphs.size(); ++i) parts[motion.morphs[i].mesh].morphs.push_back(static_cast<rt_u32>(i));
    for (const Skin& skin : motion.skins) parts[skin.mesh].skin = &skin;
    return parts;
}

void take_frame(const Motion& motion, const VertexFrames& frames, double time_s, std::vector<float>& positions) {
    const double* times = &motion.frame_times[frames.first_time];
    const auto after = std::upper_bound(times, times + frames.frame_count, time_s);
    const uint64_t next = std::min<uint64_t>(static_cast<uint64_t>(after - times), frames.frame_count - 1);
    const uint64_t last = after == times ? 0 : static_cast<uint64_t>(after - times) - 1;
    const double span = times[next] - times[last], x = span > 0 ? (time_s - times[last]) / span : 0;
    const float* a = &motion.frame_positions[frames.first_position + last * positions.size()];
    const float* b = &motion.frame_positions[frames.first_position + next * positions.size()];
    for (size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(a[i] + (double(b[i]) - a[i]) * x);
}

void add_target(const Motion& motion, const MorphTarget& target, double factor, PosedMesh& mesh) {
    if (factor == 0) return;
    for (uint64_t i = 0; i < target.count; ++i) {
        const size_t v = motion.morph_vertices[target.first + i];
        for (int k = 0; k < 3; ++k) {
            mesh.positions[3 * v + k] += static_cast<float>(factor * motion.morph_positions[3 * (target.first + i) + k]);
            if (!mesh.normals.empty() && target.has_normals)
                mesh.normals[3 * v + k] += static_cast<float>(factor * motion.morph_normals[target.first_normal + 3 * i + k]);
        }
    }
}

// Offsets are interpolated between targets, of which the mesh at rest is one, of weight 0. Beyond the outer ones they go
// straight on.
void add_morph(const Motion& motion, const Morph& morph, double weight, PosedMesh& mesh) {
    std::vector<std::pair<double, const MorphTarget*>> knots = {{0, nullptr}};
    for (rt_u32 i = 0; i < morph.target_count; ++i) {
        const MorphTarget& target = motion.morph_targets[morph.first_target + i];
        knots.push_back({target.weight, &target});
    }
    std::stable_sort(knots.begin(), knots.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    size_t high = 1;
    while (high + 1 < knots.size() && knots[high].first < weight) ++high;
    if (high >= knots.size()) return;
    const auto &below = knots[high - 1], &above = knots[high];
    const double span = above.first - below.first, x = span > 0 ? (weight - below.first) / span : 1;
    if (above.second) add_target(motion, *above.second, x, mesh);
    if (below.second) add_target(motion, *below.second, 1 - x, mesh);
}

// ---- skins

// Kavan, Collins, Zara, O'Sullivan (2008), "Geometric Skinning with Approximate Dual Quaternion Blending".
struct DualQuaternion {
    Quaternion real{0, 0, 0, 0}, dual{0, 0, 0, 0};
    Vec scale{};
};

DualQuaternion dual_quaternion(const Matrix& m) {
    Matrix turn = m;
    DualQuaternion d;
    for (int j = 0; j < 3; ++j) {
        double length = std::sqrt(m[j] * m[j] + m[4 + j] * m[4 + j] + m[8 + j] * m[8 + j]);
        if (j == 2 && determinant(m) < 0) length = -length;
        d.scale[j] = length;
        for (int i = 0; i < 3; ++i) turn[4 * i + j] = length != 0 ? m[4 * i + j] / length : (i == j ? 1 : 0);
    }
    d.real = quaternion_of(turn);
    d.dual = Quaternion{m[3], m[7], m[11], 0} * d.real;
    for (double& x : d.dual) x *= 0.5;
    return d;
}

void add(DualQuaternion& sum, const DualQuaternion& d, double weight) {
    double cosine = 0;
    for (int i = 0; i < 4; ++i) cosine += sum.real[i] * d.real[i];
    const double w = cosine < 0 ? -weight : weight;  // q and -q are the same rotation
    for (int i = 0; i < 4; ++i) {
        sum.real[i] += w * d.real[i];
        sum.dual[i] += w * d.dual[i];
    }
    for (int i = 0; i < 3; ++i) sum.scale[i] += weight * d.scale[i];
}

Matrix matrix_of(const DualQuaternion& sum) {
    double length = 0;
    for (const double x : sum.real) length += x * x;
    length = std::sqrt(length);
    if (!(length > 0)) return kIdentityMatrix;
    Quaternion real = sum.real, dual = sum.dual;
    for (double& x : real) x /= length;
    for (double& x : dual) x /= length;
    const Quaternion moved = dual * Quaternion{-real[0], -real[1], -real[2], real[3]};
    Matrix m = rotation(real) * scaling(sum.scale);
    for (int i = 0; i < 3; ++i) m[4 * i + 3] = 2 * moved[i];
    return m;
}

Matrix blended(const Matrix& a, const Matrix& b, double x) {
    Matrix m{};
    for (int i = 0; i < 12; ++i) m[i] = a[i] + (b[i] - a[i]) * x;
    return m;
}

void put_point(const Matrix& m, float* p) {
    const Vec q = point(m, {p[0], p[1], p[2]});
    for (int i = 0; i < 3; ++i) p[i] = static_cast<float>(q[i]);
}

// The instance whose node moves the vertices without weights.
const Instance* instance_of(const Scene& scene, rt_u32 mesh) {
    for (const Instance& instance : scene.instances)
        if (instance.node != RT_NONE && instance.moving_mesh == mesh) return &instance;
    return nullptr;
}

void apply_skin(const Scene& scene, const Deformers& deformers, const Skin& skin, PosedMesh& mesh) {
    const Motion& motion = scene.motion;
    Matrix root_from_world = kIdentityMatrix;
    if (skin.root != RT_NONE && !invert(deformers.nodes[skin.root].world, root_from_world))
        return;  // flattened: nothing is seen
    const Instance* instance = instance_of(scene, skin.mesh);
    const Matrix unweighted =
        instance ? root_from_world * deformers.nodes[instance->node].world * to_matrix(instance->node_from_object)
                 : kIdentityMatrix;
    std::vector<Matrix> bones(skin.bone_count);
    std::vector<DualQuaternion> duals(skin.method == RT_SKIN_LINEAR ? 0 : skin.bone_count);
    for (rt_u32 b = 0; b < skin.bone_count; ++b) {
        const Bone& bone = motion.bones[skin.first_bone + b];
        Matrix from_mesh{};
        std::copy_n(bone.bone_from_mesh, 12, from_mesh.begin());
        bones[b] = root_from_world * deformers.nodes[bone.node].world * from_mesh;
        if (!duals.empty()) duals[b] = dual_quaternion(bones[b]);
    }
    const rt_weight* weights = motion.weights.data() + skin.first_weight;
    const size_t vertex_count = mesh.positions.size() / 3;
    const auto first_weight = [&](size_t v) {
        return std::lower_bound(weights, weights + skin.weight_count, v,
                                [](const rt_weight& w, size_t vertex) { return w.vertex < vertex; });
    };
    constexpr size_t kChunk = 4096;
    parallel_for((vertex_count + kChunk - 1) / kChunk, [&](size_t chunk) {
        const size_t end = std::min(vertex_count, (chunk + 1) * kChunk);
        const rt_weight* w = first_weight(chunk * kChunk);
        for (size_t v = chunk * kChunk; v < end; ++v) {
            Matrix m{};
            DualQuaternion dual;
            double sum = 0;
            for (; w != weights + skin.weight_count && w->vertex == v; ++w) {
                sum += w->weight;
                for (int i = 0; i < 12; ++i) m[i] += w->weight * bones[w->bone][i];
                if (!duals.empty()) add(dual, duals[w->bone], w->weight);
            }
            if (sum > 0) {
                for (double& x : m) x /= sum;
                for (double& x : dual.scale) x /= sum;
                if (skin.method == RT_SKIN_DUAL_QUATERNION) m = matrix_of(dual);
                if (skin.method == RT_SKIN_BLENDED) m = blended(m, matrix_of(dual), motion.shares[skin.first_share + v]);
            } else {
                m = unweighted;
            }
            put_point(m, &mesh.positions[3 * v]);
            if (mesh.normals.empty()) continue;
            float* normal = &mesh.normals[3 * v];
            Vec turned = direction(cofactors(m), {normal[0], normal[1], normal[2]});
            const double length = std::sqrt(dot(turned, turned));
            for (int i = 0; i < 3; ++i) normal[i] = length > 0 ? static_cast<float>(turned[i] / length) : 0;
        }
    });
}

}  // namespace

PosedMesh at_rest(const Scene& scene, rt_u32 index) {
    const Mesh& mesh = scene.meshes[index];
    PosedMesh out;
    out.mesh = index;
    const auto range = [&](const std::vector<float>& values) {
        const auto first = values.begin() + 3 * static_cast<std::ptrdiff_t>(mesh.first_vertex);
        return std::vector<float>(first, first + 3 * static_cast<std::ptrdiff_t>(mesh.vertex_count));
    };
    out.positions = range(scene.positions);
    if (!scene.normals.empty()) out.normals = range(scene.normals);
    return out;
}

void renew_normals(const Scene& scene, PosedMesh& out) {
    const Mesh& mesh = scene.meshes[out.mesh];
    std::vector<Vec> sums(mesh.vertex_count, Vec{});
    const auto position = [&](rt_u32 v) {
        return Vec{out.positions[3 * size_t(v)], out.positions[3 * size_t(v) + 1], out.positions[3 * size_t(v) + 2]};
    };
    for (size_t t = mesh.first_triangle; t < size_t(mesh.first_triangle) + mesh.triangle_count; ++t) {
        rt_u32 corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = scene.triangles[3 * t + k] - mesh.first_vertex;
        const Vec a = position(corner[0]), normal = cross(position(corner[1]) - a, position(corner[2]) - a);
        for (const rt_u32 v : corner)
            for (int i = 0; i < 3; ++i) sums[v][i] += normal[i];
    }
    for (size_t v = 0; v < sums.size(); ++v) {
        float* normal = &out.normals[3 * v];
        const double length = std::sqrt(dot(sums[v], sums[v]));
        const bool has_one = normal[0] != 0 || normal[1] != 0 || normal[2] != 0;
        for (int i = 0; i < 3; ++i) normal[i] = has_one && length > 0 ? static_cast<float>(sums[v][i] / length) : 0;
    }
}

std::vector<PosedMesh> deform(const Scene& scene, const Deformers& deformers) {
    const Motion& motion = scene.motion;
    std::vector<PosedMesh> meshes;
    for (const auto& [index, parts] : parts_by_mesh(motion)) {
        PosedMesh out = at_rest(scene, index);
        if (parts.frames) {
            take_frame(motion, *parts.frames, deformers.time_s, out.positions);
            if (!out.normals.empty()) renew_normals(scene, out);
        }
        for (const rt_u32 morph : parts.morphs) add_morph(motion, motion.morphs[morph], deformers.morph_weights[morph], out);
        if (parts.skin) apply_skin(scene, deformers, *parts.skin, out);
        meshes.push_back(std::move(out));
    }
    return meshes;
}

}  // namespace clarity
