/* basis.h -- the local frame of a normal, in which surfaces scatter light: z along the normal.
 *
 * Duff et al. 2017, Building an Orthonormal Basis, Revisited. */
#ifndef RT_BASIS_H
#define RT_BASIS_H

typedef struct rt_basis {
    rt_vec x, y, z; /* unit, in the world */
} rt_basis;

RT_INLINE rt_basis rt_basis_of(rt_vec n)
{
    const vfloat one = rt_vfloat(1.0f), sign = copysign(one, n.z), a = -one / (sign + n.z), b = n.x * n.y * a;
    rt_basis basis;
    basis.x = rt_vec_of(fma(sign * n.x, n.x * a, one), sign * b, -sign * n.x);
    basis.y = rt_vec_of(b, fma(n.y, n.y * a, sign), -n.y);
    basis.z = n;
    return basis;
}

RT_INLINE rt_vec rt_to_local(const rt_basis *b, rt_vec v) { return rt_vec_of(rt_dot(b->x, v), rt_dot(b->y, v), rt_dot(b->z, v)); }
RT_INLINE rt_vec rt_to_world(const rt_basis *b, rt_vec v) { return rt_along(v.x, b->x, rt_along(v.y, b->y, rt_scale(v.z, b->z))); }

#endif
