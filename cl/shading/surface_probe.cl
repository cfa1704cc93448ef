/* surface_probe.cl -- what the three functions of one model of surfaces answer, without scene and tracer. For `clarity check`, which
 * defines their names, and RT_PROBE_SHARE: how many queries each work-item takes. */

/* queries: wo, wi and u. answers: direction, weight and pdf that are drawn for wo and u; eval and pdf of wi; those of the direction
 * that was drawn, 0 where none was. */
kernel void probe_model(const global float *numbers, const global float *queries, global float *answers, uint count, float red, float green,
                        float blue)
{
    const float3 color = (float3)(red, green, blue);
    const uint first = (uint)get_global_id(0) * RT_PROBE_SHARE, end = min(first + RT_PROBE_SHARE, count);
    for (uint i = first; i < end; ++i) {
        const float3 wo = vload3(3u * i, queries), wi = vload3(3u * i + 1u, queries), u = vload3(3u * i + 2u, queries);
        const rt_surface_draw draw = RT_PROBE_SAMPLE(numbers, color, wo, u);
        global float *a = answers + 15u * i;
        const bool drawn = draw.pdf > 0.0f && draw.wi.z > 0.0f;
        vstore3(draw.wi, 0, a);
        vstore3(draw.weight, 0, a + 3);
        a[6] = draw.pdf;
        vstore3(RT_PROBE_EVAL(numbers, color, wo, wi), 0, a + 7);
        a[10] = RT_PROBE_PDF(numbers, color, wo, wi);
        vstore3(drawn ? RT_PROBE_EVAL(numbers, color, wo, draw.wi) : (float3)(0.0f), 0, a + 11);
        a[14] = drawn ? RT_PROBE_PDF(numbers, color, wo, draw.wi) : 0.0f;
    }
}
