/* deform.cl -- vertices of meshes that deform: between two frames, or at rest, then morph targets, then a skin. The same steps in
 * the same order as the host's deform.cpp, with the same rounding, so that both make the same vertices.
 *
 * A work-group makes a chunk of one mesh. "Number" of a vertex: among those of all meshes that deform. Nothing is written by two
 * work-items, so there are no atomics: morph targets and triangles are listed by vertex. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF

/* What moves one mesh: DeviceDeformation of device_deformer.hpp. 152 B. Matrices have 3 rows of 4. */
typedef struct rt_deformation {
    ulong before, after; /* first numbers of two frames */
    double frame_share;  /* of the second one */
    double unweighted[12];
    uint first, count;    /* numbers of its vertices */
    uint first_vertex;    /* in the scene */
    uint first_bone;      /* in the table of bones */
    uint has_frames;      /* positions are there already, and normals where the scene has them */
    uint skin;            /* RT_LINEAR_SKIN ...; RT_NO_SKIN */
    uint acts, pad;       /* acts: 0 leaves the mesh as it is */
} rt_deformation;
#define RT_LINEAR_SKIN 0u
#define RT_DUAL_SKIN 1u
#define RT_BLENDED_SKIN 2u
#define RT_NO_SKIN 0xffffffffu

/* chunks: the mesh and the first vertex of each work-group, counted within the mesh. each: vertices of a work-group. */
#define RT_CHUNK                                                                                   \
    const global rt_deformation *const mesh = meshes + chunks[2u * RT_GROUP_NUMBER];                 \
    const uint begin = chunks[2u * RT_GROUP_NUMBER + 1u], end = min(begin + each, mesh->count);      \
    if (!mesh->acts) return;
#define RT_EACH_VERTEX(v) for (uint v = begin + RT_ITEM; v < end; v += RT_GROUP)

RT_BUILD_KERNEL deform_frames(const global rt_deformation *meshes, const global uint *chunks, uint each, const global float *frames,
                              global float *positions)
{
    RT_CHUNK
    if (!mesh->has_frames) return;
    RT_EACH_VERTEX(v) {
        for (uint k = 0u; k < 3u; ++k) {
            const float a = frames[mesh->before + 3u * v + k], b = frames[mesh->after + 3u * v + k];
            positions[3u * (mesh->first_vertex + v) + k] = (float)(a + ((double)b - a) * mesh->frame_share);
        }
    }
}

RT_INLINE double3 rt_load_double3(const global float *three) { return (double3)(three[0], three[1], three[2]); }
RT_INLINE double3 rt_cross(double3 a, double3 b)
{
    return (double3)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
RT_INLINE double rt_length(double3 a) { return sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }
/* Of unit length, as floats; zero stays zero. */
RT_INLINE float3 rt_unit(double3 a)
{
    const double length = rt_length(a);
    return length > 0.0 ? (float3)((float)(a.x / length), (float)(a.y / length), (float)(a.z / length)) : (float3)(0.0f);
}

/* Normals of meshes with frames: renew_normals() of deform.cpp. around: from first_around[number] on, the triangles at a vertex, in
 * ascending order. corners: three vertices of each triangle, counted within its mesh. */
RT_BUILD_KERNEL deform_normals(const global rt_deformation *meshes, const global uint *chunks, uint each,
                               const global float *rest_normals, const global uint *first_around, const global uint *around,
                               const global uint *corners, const global float *positions, global float *normals)
{
    RT_CHUNK
    if (!mesh->has_frames) return;
    const global float *const of_mesh = positions + 3u * (ulong)mesh->first_vertex;
    RT_EACH_VERTEX(v) {
        const uint number = mesh->first + v;
        const float3 at_rest = vload3(number, rest_normals);
        double3 sum = (double3)(0.0);
        for (uint i = first_around[number]; i < first_around[number + 1u]; ++i) {
            const uint3 corner = vload3(around[i], corners);
            const double3 a = rt_load_double3(of_mesh + 3u * corner.x);
            sum += rt_cross(rt_load_double3(of_mesh + 3u * corner.y) - a, rt_load_double3(of_mesh + 3u * corner.z) - a);
        }
        const bool has_one = at_rest.x != 0.0f || at_rest.y != 0.0f || at_rest.z != 0.0f;
        vstore3(has_one ? rt_unit(sum) : (float3)(0.0f), mesh->first_vertex + v, normals);
    }
}

/* Where a vertex is added to the sum of its bones. Dual quaternions: 12 numbers each, of which the real part, the dual part and
 * three scales are used (dual_quaternion.hpp). */
typedef struct rt_bones {
    double matrix[12], weight;
    double4 real, dual;
    double3 scale;
} rt_bones;
RT_INLINE void rt_add_dual(rt_bones *sum, const global double *of_bone, double weight)
{
    const double4 real = vload4(0, of_bone), dual = vload4(1, of_bone);
    double cosine = 0.0;
    cosine += sum->real.x * real.x;
    cosine += sum->real.y * real.y;
    cosine += sum->real.z * real.z;
    cosine += sum->real.w * real.w;
    const double w = cosine < 0.0 ? -weight : weight; /* q and -q are the same rotation */
    sum->real += w * real;
    sum->dual += w * dual;
    sum->scale += weight * vload3(0, of_bone + 8u);
}
/* matrix_of() of dual_quaternion.cpp. */
RT_INLINE void rt_matrix_of_dual(const rt_bones *sum, double *m)
{
    const double length = sqrt(sum->real.x * sum->real.x + sum->real.y * sum->real.y + sum->real.z * sum->real.z +
                               sum->real.w * sum->real.w);
    if (!(length > 0.0)) {
        for (uint i = 0u; i < 12u; ++i) m[i] = i % 5u == 0u ? 1.0 : 0.0;
        return;
    }
    const double4 q = sum->real / length, a = sum->dual / length, b = (double4)(-q.x, -q.y, -q.z, q.w);
    const double3 s = sum->scale;
    m[0] = (1.0 - 2.0 * (q.y * q.y + q.z * q.z)) * s.x;
    m[1] = 2.0 * (q.x * q.y - q.w * q.z) * s.y;
    m[2] = 2.0 * (q.x * q.z + q.w * q.y) * s.z;
    m[3] = 2.0 * (a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y);
    m[4] = 2.0 * (q.x * q.y + q.w * q.z) * s.x;
    m[5] = (1.0 - 2.0 * (q.x * q.x + q.z * q.z)) * s.y;
    m[6] = 2.0 * (q.y * q.z - q.w * q.x) * s.z;
    m[7] = 2.0 * (a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x);
    m[8] = 2.0 * (q.x * q.z - q.w * q.y) * s.x;
    m[9] = 2.0 * (q.y * q.z + q.w * q.x) * s.y;
    m[10] = (1.0 - 2.0 * (q.x * q.x + q.y * q.y)) * s.z;
    m[11] = 2.0 * (a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w);
}

/* The matrix that a skin moves a vertex by. weights: from first_weight[number] on, number of a bone and weight. */
RT_INLINE void rt_skin_matrix(const global rt_deformation *mesh, uint number, const global uint *first_weight,
                              const global uint2 *weights, float dual_share, const global double *bones, const global double *duals,
                              double *m)
{
    rt_bones sum;
    for (uint i = 0u; i < 12u; ++i) sum.matrix[i] = 0.0;
    sum.weight = 0.0;
    sum.real = sum.dual = (double4)(0.0);
    sum.scale = (double3)(0.0);
    for (uint i = first_weight[number]; i < first_weight[number + 1u]; ++i) {
        const uint bone = mesh->first_bone + weights[i].x;
        const double weight = as_float(weights[i].y);
        sum.weight += weight;
        for (uint k = 0u; k < 12u; ++k) sum.matrix[k] += weight * bones[12u * bone + k];
        if (mesh->skin != RT_LINEAR_SKIN) rt_add_dual(&sum, duals + 12u * bone, weight);
    }
    if (!(sum.weight > 0.0)) {
        for (uint i = 0u; i < 12u; ++i) m[i] = mesh->unweighted[i];
        return;
    }
    for (uint i = 0u; i < 12u; ++i) m[i] = sum.matrix[i] / sum.weight;
    if (mesh->skin == RT_LINEAR_SKIN) return;
    double of_dual[12];
    sum.scale /= sum.weight;
    rt_matrix_of_dual(&sum, of_dual);
    const double share = dual_share;
    for (uint i = 0u; i < 12u; ++i) m[i] = mesh->skin == RT_DUAL_SKIN ? of_dual[i] : m[i] + (of_dual[i] - m[i]) * share;
}

/* Targets and skins. entries: from first_entry[number] on, the targets that move a vertex, ascending; offsets and normal_offsets:
 * three numbers for each. The shares of all targets, the bones' matrices and their dual quaternions follow the meshes, from these
 * numbers of 8 B on. has_normals: of the scene; the pointers to normals are otherwise unused. */
RT_BUILD_KERNEL deform_vertices(const global rt_deformation *meshes, const global uint *chunks, uint each,
                                const global float *rest_positions, const global float *rest_normals, const global uint *first_entry,
                                const global uint *entries, const global float *offsets, const global float *normal_offsets,
                                const global uint *first_weight, const global uint2 *weights, const global float *dual_shares,
                                uint first_share, uint first_bone, uint first_dual, uint has_normals, global float *positions, global float *normals)
{
    RT_CHUNK
    const global double *const numbers = (const global double *)meshes, *const shares = numbers + first_share;
    RT_EACH_VERTEX(v) {
        const uint number = mesh->first + v, vertex = mesh->first_vertex + v;
        const bool from_frames = mesh->has_frames != 0u;
        float3 p = from_frames ? vload3(vertex, positions) : vload3(number, rest_positions), n = (float3)(0.0f);
        if (has_normals) n = from_frames ? vload3(vertex, normals) : vload3(number, rest_normals);
        for (uint i = first_entry[number]; i < first_entry[number + 1u]; ++i) {
            const double share = shares[entries[i]];
            if (share == 0.0) continue;
            const float3 offset = vload3(i, offsets);
            p += (float3)((float)(share * offset.x), (float)(share * offset.y), (float)(share * offset.z));
            if (!has_normals) continue;
            const float3 turn = vload3(i, normal_offsets);
            n += (float3)((float)(share * turn.x), (float)(share * turn.y), (float)(share * turn.z));
        }
        if (mesh->skin != RT_NO_SKIN) {
            double m[12];
            rt_skin_matrix(mesh, number, first_weight, weights, dual_shares[number], numbers + first_bone, numbers + first_dual, m);
            const double x = p.x, y = p.y, z = p.z;
            p = (float3)((float)(m[0] * x + m[1] * y + m[2] * z + m[3]), (float)(m[4] * x + m[5] * y + m[6] * z + m[7]),
                         (float)(m[8] * x + m[9] * y + m[10] * z + m[11]));
            /* Cofactors turn normals, up to their length. */
            const double3 r0 = (double3)(m[0], m[1], m[2]), r1 = (double3)(m[4], m[5], m[6]), r2 = (double3)(m[8], m[9], m[10]);
            const double3 c0 = rt_cross(r1, r2), c1 = rt_cross(r2, r0), c2 = rt_cross(r0, r1);
            const double a = n.x, b = n.y, c = n.z;
            if (has_normals)
                n = rt_unit((double3)(c0.x * a + c0.y * b + c0.z * c, c1.x * a + c1.y * b + c1.z * c, c2.x * a + c2.y * b + c2.z * c));
        }
        vstore3(p, vertex, positions);
        if (has_normals) vstore3(n, vertex, normals);
    }
}
