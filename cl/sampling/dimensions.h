/* dimensions.h -- the random numbers of a path, by their dimensions: which number serves which purpose.
 *
 * Numbers depend on pixel, sample, dimension and seed alone, and so do pictures: not on packets, tiles, devices or order.
 * Dimensions come in sets of four. The first set is the camera's; each scattering event has two sets.
 *
 *   set          dimension   purpose
 *   0            0, 1        point within the pixel (and its filter)
 *                2, 3        point on the lens
 *   1 + 2 event  0           lobe of the surface
 *                1, 2        direction by that lobe
 *                3           Russian roulette
 *   2 + 2 event  0           pick of a light
 *                1, 2        point or direction of that light
 *                3           the light tree, if the pick is of it
 *   beyond       0           whether a surface that is there in part stops the ray: a set for each that it meets before its next event */
#ifndef RT_DIMENSIONS_H
#define RT_DIMENSIONS_H

#define RT_CAMERA_SET rt_vint(0)
#define RT_SURFACE_SET(event) (rt_vint(1) + (event) * rt_vint(2))
#define RT_LIGHT_SET(event) (rt_vint(2) + (event) * rt_vint(2))
#define RT_CUTOUT_SET(event, step) (rt_vint(4096) + (event) * rt_vint(4096) + rt_vint((int)(step)))

typedef struct rt_sampler {
    vint pixel;  /* its number in the picture */
    vint sample; /* its number in the pixel */
    uint end;    /* beyond the samples of this launch */
    uint seed, sobol;
} rt_sampler;

/* Four numbers in [0, 1). */
typedef struct rt_numbers {
    vfloat a, b, c, d;
} rt_numbers;

/* The four numbers of a set. With Sobol's points each set is a point of four dimensions, and sets are independent. */
RT_PART rt_numbers rt_draw_set(const rt_sampler *s, vint set)
{
    const vuint sample = rt_as_vuint(s->sample);
    rt_hashes bits = rt_hash(rt_as_vuint(s->pixel), s->sobol != 0u ? rt_vuint(0x68bc21ebu) : sample, rt_as_vuint(set), rt_vuint(s->seed));
    if (s->sobol != 0u) bits = rt_sobol(sample, s->end, &bits);
    rt_numbers n;
    n.a = rt_unit_interval(bits.a);
    n.b = rt_unit_interval(bits.b);
    n.c = rt_unit_interval(bits.c);
    n.d = rt_unit_interval(bits.d);
    return n;
}

#endif
