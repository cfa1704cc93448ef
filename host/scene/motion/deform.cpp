#include "scene/motion/deform.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel_for.hpp"

namespace clarity {
namespace {

void take_frames(const Motion& motion, const Deformation& d, std::vector<float>& positions) {
    const float* frames = &motion.frame_positions[motion.frames[d.frames].first_position];
    const float *a = frames + d.frame_before * positions.size(), *b = frames + d.frame_after * positions.size();
    for (size_t i = 0; i < positions.size(); ++i)
        positions[i] = static_cast<float>(a[i] + (double(b[i]) - a[i]) * d.frame_share);
}

void add_target(const Motion& motion, const Deformation::TargetShare& added, PosedMesh& mesh) {
    const MorphTarget& target = motion.morph_targets[added.target];
    for (uint64_t i = 0; i < target.count; ++i) {
        const size_t v = motion.morph_vertices[target.first + i];
        for (int k = 0; k < 3; ++k) {
            mesh.positions[3 * v + k] += static_cast<float>(added.share * motion.morph_positions[3 * (target.first + i) + k]);
            if (!mesh.normals.empty() && target.has_normals)
                mesh.normals[3 * v + k] +=
                    static_cast<float>(added.share * motion.morph_normals[target.first_normal + 3 * i + k]);
        }
    }
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

void apply_skin(const Motion& motion, const Deformation& d, PosedMesh& mesh) {
    const Skin& skin = motion.skins[d.skin];
    std::vector<DualQuaternion> duals;
    if (skin.method != RT_SKIN_LINEAR)
        for (const Matrix& bone : d.bones) duals.push_back(dual_quaternion(bone));
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
                for (int i = 0; i < 12; ++i) m[i] += w->weight * d.bones[w->bone][i];
                if (!duals.empty()) add(dual, duals[w->bone], w->weight);
            }
            if (sum > 0) {
                for (double& x : m) x /= sum;
                for (double& x : dual.scale) x /= sum;
                if (skin.method == RT_SKIN_DUAL_QUATERNION) m = matrix_of(dual);
                if (skin.method == RT_SKIN_BLENDED) m = blended(m, matrix_of(dual), motion.shares[skin.first_share + v]);
            } else {
                m = d.unweighted;
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

StoredVertices stored_vertices(const Scene& scene, rt_u32 mesh) {
    const Motion& motion = scene.motion;
    const auto found = std::lower_bound(motion.stored.begin(), motion.stored.end(), mesh,
                                        [](const StoredMesh& stored, rt_u32 number) { return stored.mesh < number; });
    const bool is_kept = found != motion.stored.end() && found->mesh == mesh;
    const size_t first = 3 * (is_kept ? found->first : uint64_t(scene.meshes[mesh].first_vertex));
    const SharedArray<float>&positions = is_kept ? motion.stored_positions : scene.positions,
          &normals = is_kept ? motion.stored_normals : scene.normals;
    return {positions.data() + first, normals.empty() ? nullptr : normals.data() + first};
}

PosedMesh stored_mesh(const Scene& scene, rt_u32 mesh) {
    const StoredVertices from = stored_vertices(scene, mesh);
    const size_t count = 3 * size_t(scene.meshes[mesh].vertex_count);
    PosedMesh out;
    out.mesh = mesh;
    out.positions.assign(from.positions, from.positions + count);
    if (from.normals) out.normals.assign(from.normals, from.normals + count);
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

PosedMesh deformed(const Scene& scene, const Deformation& deformation) {
    PosedMesh mesh = stored_mesh(scene, deformation.mesh);
    if (deformation.frames != RT_NONE) {
        take_frames(scene.motion, deformation, mesh.positions);
        if (!mesh.normals.empty()) renew_normals(scene, mesh);
    }
    for (const Deformation::TargetShare& target : deformation.targets) add_target(scene.motion, target, mesh);
    if (deformation.skin != RT_NONE) apply_skin(scene.motion, deformation, mesh);
    return mesh;
}

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

}  // namespace clarity
