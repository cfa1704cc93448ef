/* one_lane.h -- one lane of a vector, through memory: slow, for recorders. */
#ifndef RT_ONE_LANE_H
#define RT_ONE_LANE_H

RT_INLINE float rt_lane(vfloat v, uint l)
{
    float values[RT_LANES];
    rt_store(v, values);
    return values[l];
}
RT_INLINE int rt_lane_int(vint v, uint l)
{
    int values[RT_LANES];
    rt_store(v, values);
    return values[l];
}
RT_INLINE void rt_lane_vec(rt_vec v, uint l, global float *out)
{
    out[0] = rt_lane(v.x, l);
    out[1] = rt_lane(v.y, l);
    out[2] = rt_lane(v.z, l);
}

#endif
