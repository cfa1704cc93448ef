/* rt_shared.h -- the few types that host, plugins and kernels share. A plugin sees no other type of the kernels: all of this is
 * part of the plugin ABI (rt_plugin.h) and changes only with RT_ABI_VERSION.
 *
 * C99 subset, scalars and arrays only, as in rt_types.h. */
#ifndef RT_SHARED_H
#define RT_SHARED_H
#ifdef __OPENCL_VERSION__
typedef uint rt_u32;
typedef int rt_i32;
typedef float rt_f32;
#else
#include <stdint.h>
typedef uint32_t rt_u32;
typedef int32_t rt_i32;
typedef float rt_f32;
#endif

#define RT_NONE 0xFFFFFFFFu

/* A ref names one primitive: its kind in the top 4 bits, its index within that kind in the low 28. */
#define RT_REF_TRIANGLE 0x00000000u
#define RT_REF_SPHERE 0x10000000u
#define RT_REF_POLYGON 0x20000000u
#define RT_REF_INSTANCE 0x30000000u
#define RT_REF_SHAPE 0x40000000u
#define RT_REF_KIND(r) ((r)&0xF0000000u)
#define RT_REF_INDEX(r) ((r)&0x0FFFFFFFu)
#define RT_REF_INDEX_MAX 0x0FFFFFFFu

/* One primitive as the leaf tests read it, packed by the host in the leaf order that the builder chose. 48 B.
 *   triangle   a, b, c = corners in the group's space
 *   sphere     a = centre, b[0] = radius
 *   polygon    a = unit normal, b = a point of its plane; corners in rt_polygon
 *   instance   a, b = lower and upper bounds in the world
 *   shape      a, b = lower and upper bounds in the world; the rest is in the host's rt_shape */
typedef struct rt_packed_prim {
    rt_f32 a[3];
    rt_u32 ref;
    rt_f32 b[3];
    rt_u32 material;
    rt_f32 c[3];
    rt_u32 prim; /* number shown as `prim`; within an instance it counts from rt_instance.first_prim */
} rt_packed_prim;

/* Kinds of lights, in rt_light_desc and in the kernels' rt_light. */
#define RT_LIGHT_POINT 0u
#define RT_LIGHT_DIRECTIONAL 1u
#define RT_LIGHT_SPOT 2u /* a point with a cone */
#define RT_LIGHT_SUN 3u  /* a disc on the sky; color: irradiance of a surface that faces it */
#define RT_LIGHT_RECT 4u /* color of a rect, a disc and a sphere: radiance */
#define RT_LIGHT_DISC 5u
#define RT_LIGHT_SPHERE 6u
#define RT_LIGHT_KINDS 7u

/* Flags of lights. Without RT_LIGHT_FALLOFF a point or spot light lights all distances alike, and it and a directional light
 * mean an irradiance of pi times color, as Whitted's model has them. With it, color is an intensity (per steradian) or an
 * irradiance. */
#define RT_LIGHT_FALLOFF 1u
#define RT_LIGHT_TWO_SIDED 2u /* rect, disc: both sides emit */
#define RT_LIGHT_STAND_IN 4u  /* by the host, for a scene without lights: no light of `path` where anything else emits */

/* What lies beyond a scene, for the path tracer. */
#define RT_SKY_CONSTANT 0u
#define RT_SKY_GRADIENT 1u /* with the sine of the elevation from horizon to zenith; below the horizon one color */
#define RT_SKY_PICTURE 2u
#define RT_SKY_KINDS 3u

/* What the path tracer takes a surface for. */
#define RT_MODEL_WHITTED 0u
#define RT_MODEL_LAMBERT 1u
#define RT_MODEL_CONDUCTOR 2u  /* GGX, with what is scattered several times between its facets */
#define RT_MODEL_DIELECTRIC 3u /* smooth, or rough as GGX */
#define RT_MODEL_GLTF 4u       /* glTF's metallic-roughness with its layers */
#define RT_MODEL_UNLIT 5u      /* shows its colour where a camera or a smooth mirror sees it; neither lit nor lighting */
#define RT_MODEL_KINDS 6u

/* Flags of materials, in rt_material_desc and in the kernels' rt_material. */
#define RT_MATERIAL_CHECKER 1u        /* a unit checkerboard of color and a third of it, in world x and z; for planes */
#define RT_MATERIAL_ONE_SIDED 2u      /* only the side that its normal points to emits light */
#define RT_MATERIAL_SINGLE_SCATTER 4u /* conductor, dielectric: what is scattered several times between facets is lost */

/* What a material uses a texture for. Channels of a picture are r, g, b and a. */
#define RT_MAP_COLOR 0u    /* rgb multiplies the colour, a the opacity */
#define RT_MAP_EMISSION 1u /* rgb multiplies the emission */
#define RT_MAP_NORMAL 2u   /* rgb is the normal in the frame of tangent, bitangent and normal: 2 rgb - 1 */
#define RT_MAP_OCCLUSION 3u          /* r: the share of ambient light */
#define RT_MAP_METALLIC_ROUGHNESS 4u /* g multiplies the roughness, b the share of metal */
#define RT_MAP_TRANSMISSION 5u       /* r */
#define RT_MAP_THICKNESS 6u          /* g */
#define RT_MAP_CLEARCOAT 7u          /* r */
#define RT_MAP_CLEARCOAT_ROUGHNESS 8u /* g */
#define RT_MAP_CLEARCOAT_NORMAL 9u    /* as RT_MAP_NORMAL */
#define RT_MAP_SPECULAR 10u           /* a */
#define RT_MAP_SPECULAR_COLOR 11u     /* rgb */
#define RT_MAP_SHEEN_COLOR 12u        /* rgb */
#define RT_MAP_SHEEN_ROUGHNESS 13u    /* a */
#define RT_MAP_ANISOTROPY 14u         /* rg is the direction, b multiplies the strength */
#define RT_MAP_IRIDESCENCE 15u        /* r */
#define RT_MAP_IRIDESCENCE_THICKNESS 16u /* g: between the least and the greatest thickness */
#define RT_MAP_OPACITY 17u               /* r multiplies the opacity */
#define RT_MAP_ROUGHNESS 18u             /* r multiplies the roughness. RT_MAP_METALLIC_ROUGHNESS is then for the metal alone */
#define RT_MAP_METALLIC 19u              /* r multiplies the share of metal; likewise */
#define RT_MAP_USES 20u
#endif
