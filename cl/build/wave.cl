/* wave.cl -- a wave that runs through the vertices of a scene, for tests and benchmarks of scenes that deform on the device. */

/* Writes vertices first .. first + count - 1: `rest` plus a wave along x + z, in y. size: of the scene; phase: 0 to 1. */
RT_BUILD_KERNEL wave_vertices(const global float *rest, global float *positions, uint first, uint count, uint each, float size, float phase)
{
    const uint begin = first + RT_GROUP_NUMBER * each, end = min(begin + each, first + count);
    for (uint v = begin + RT_ITEM; v < end; v += RT_GROUP) {
        float3 p = vload3(v, rest);
        p.y += 0.03f * size * sinpi(2.0f * (4.0f * (p.x + p.z) / size + phase));
        vstore3(p, v, positions);
    }
}
