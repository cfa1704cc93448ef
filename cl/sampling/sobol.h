/* sobol.h -- points of Sobol's sequence in four dimensions, shuffled and scrambled.
 *
 * Burley 2020, Practical Hash-based Owen Scrambling; directions by Joe, Kuo 2008, Constructing Sobol sequences with better
 * two-dimensional projections. Numbers are handled with their bits reversed, as Laine and Karras 2011 permute them: there a bit
 * depends on lower bits only. */
#ifndef RT_SOBOL_H
#define RT_SOBOL_H

/* The directions of dimensions 1 to 3, reversed: that of bit i of the index has no bit above i. Dimension 0 is the index. */
constant uint rt_sobol_directions[3][32] = {
    {0x00000001u, 0x00000003u, 0x00000005u, 0x0000000fu, 0x00000011u, 0x00000033u, 0x00000055u, 0x000000ffu,
     0x00000101u, 0x00000303u, 0x00000505u, 0x00000f0fu, 0x00001111u, 0x00003333u, 0x00005555u, 0x0000ffffu,
     0x00010001u, 0x00030003u, 0x00050005u, 0x000f000fu, 0x00110011u, 0x00330033u, 0x00550055u, 0x00ff00ffu,
     0x01010101u, 0x03030303u, 0x05050505u, 0x0f0f0f0fu, 0x11111111u, 0x33333333u, 0x55555555u, 0xffffffffu},
    {0x00000001u, 0x00000003u, 0x00000006u, 0x00000009u, 0x00000017u, 0x0000003au, 0x00000071u, 0x000000a3u,
     0x00000116u, 0x00000339u, 0x00000677u, 0x000009aau, 0x00001601u, 0x00003903u, 0x00007706u, 0x0000aa09u,
     0x00010117u, 0x0003033au, 0x00060671u, 0x000909a3u, 0x00171616u, 0x003a3939u, 0x00717777u, 0x00a3aaaau,
     0x01170001u, 0x033a0003u, 0x06710006u, 0x09a30009u, 0x16160017u, 0x3939003au, 0x77770071u, 0xaaaa00a3u},
    {0x00000001u, 0x00000003u, 0x00000004u, 0x0000000au, 0x0000001fu, 0x0000002eu, 0x00000045u, 0x000000c9u,
     0x0000011bu, 0x000002a4u, 0x0000079au, 0x00000b67u, 0x0000101eu, 0x0000302du, 0x00004041u, 0x0000a0c3u,
     0x0001f104u, 0x0002e28au, 0x000457dfu, 0x000c9baeu, 0x0011a105u, 0x002a7289u, 0x0079e7dbu, 0x00b6dba4u,
     0x0100011au, 0x030002a7u, 0x0400079eu, 0x0a000b6du, 0x1f001001u, 0x2e003003u, 0x45004004u, 0xc900a00au}};

RT_INLINE vuint rt_reverse(vuint x)
{
    x = x >> rt_vuint(16u) | x << rt_vuint(16u);
    x = (x >> rt_vuint(8u) & rt_vuint(0x00ff00ffu)) | (x & rt_vuint(0x00ff00ffu)) << rt_vuint(8u);
    x = (x >> rt_vuint(4u) & rt_vuint(0x0f0f0f0fu)) | (x & rt_vuint(0x0f0f0f0fu)) << rt_vuint(4u);
    x = (x >> rt_vuint(2u) & rt_vuint(0x33333333u)) | (x & rt_vuint(0x33333333u)) << rt_vuint(2u);
    return (x >> rt_vuint(1u) & rt_vuint(0x55555555u)) | (x & rt_vuint(0x55555555u)) << rt_vuint(1u);
}

/* Owen's scrambling of a reversed number; constants by Burley. */
RT_INLINE vuint rt_scramble(vuint x, vuint seed)
{
    x ^= x * rt_vuint(0x3d20adeau);
    x += seed;
    x *= seed >> rt_vuint(16u) | rt_vuint(1u);
    x ^= x * rt_vuint(0x05526c56u);
    x ^= x * rt_vuint(0x53a22864u);
    return x;
}

/* Point `index` of a sequence of its own for each seeds. end: no lane's index reaches it.
 *
 * The index is shuffled by a scrambling that keeps 0 in its place, so it keeps its highest bit, and bits above need no work.
 * That moves points as an exclusive or with a constant does, which the scrambling of the values hides: the distribution is that
 * of Burley's points. */
RT_INLINE rt_hashes rt_sobol(vuint index, uint end, const rt_hashes *seeds)
{
    const vuint seed = seeds->a ^ seeds->b << rt_vuint(7u) ^ seeds->c >> rt_vuint(9u) ^ seeds->d * rt_vuint(0x9e3779b9u);
    const vuint at = rt_reverse(rt_scramble(rt_reverse(index), seed) ^ rt_scramble(rt_vuint(0u), seed));
    rt_hashes x;
    x.a = at;
    x.b = x.c = x.d = rt_vuint(0u);
    for (uint bit = 0; bit < 32u && (end - 1u) >> bit != 0u; ++bit) {
        const vuint set = rt_vuint(0u) - (at >> rt_vuint(bit) & rt_vuint(1u));
        x.b ^= set & rt_vuint(rt_sobol_directions[0][bit]);
        x.c ^= set & rt_vuint(rt_sobol_directions[1][bit]);
        x.d ^= set & rt_vuint(rt_sobol_directions[2][bit]);
    }
    x.a = rt_reverse(rt_scramble(x.a, seeds->a));
    x.b = rt_reverse(rt_scramble(x.b, seeds->b));
    x.c = rt_reverse(rt_scramble(x.c, seeds->c));
    x.d = rt_reverse(rt_scramble(x.d, seeds->d));
    return x;
}

#endif
