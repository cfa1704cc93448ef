/* rt_types.h -- structs shared by host and kernels. Plugins see only those of rt_shared.h, so these may change at any time.
 *
 * C99 subset, scalars and arrays only: no vector types (float3 is 16 bytes wide and aligned on a device), no bool, no
 * size_t, no pointers, no integer stored as a float. Sizes are checked on the host (static_assert) and on every device (a line
 * of the kernels that the host generates). */
#ifndef RT_TYPES_H
#define RT_TYPES_H
#ifndef __OPENCL_VERSION__
#include "rt_shared.h" /* in kernels the host writes its text in front of this one */
#endif

/* Corners of a triangle as indices into the vertex attributes (normals, uvs). 12 B. Read by shading only. */
typedef struct rt_triangle {
    rt_u32 v[3];
} rt_triangle;

/* Corners of a planar polygon: corner i is polygon_corners[3 * (first + i) .. + 2]. 8 B. */
typedef struct rt_polygon {
    rt_u32 first, count;
} rt_polygon;

/* A plane: dot(normal, x) = offset. It is unbounded, so no tree holds it. normal has unit length. 32 B. */
typedef struct rt_plane {
    rt_f32 normal[3];
    rt_f32 offset;
    rt_u32 material, prim, pad[2];
} rt_plane;

/* A mesh placed in the world. object_from_world is row-major 3x4. 64 B. */
typedef struct rt_instance {
    rt_f32 object_from_world[12];
    rt_u32 root;       /* root of the mesh's tree, as the builder reported it */
    rt_u32 first_prim; /* number of the instance's first triangle */
    rt_u32 material;   /* of the whole instance; RT_NONE: each triangle has its own */
    rt_u32 hidden;     /* bits of the kinds of rays that pass it, RT_SEEN_BY_*; RT_NONE: all rays. Kernels of scenes without masks only
                        * ask whether it is 0 */
} rt_instance;
/* Kinds of rays, as bits of a mask. A ray hits an instance if it has a bit that the instance's mask has. The bits above are for rays of
 * the user's own. */
#define RT_SEEN_BY_CAMERA 1u
#define RT_SEEN_BY_SHADOW 2u
#define RT_SEEN_BY_MIRROR 4u /* all other rays of pictures: mirrored, refracted, scattered */
#define RT_SEEN_BY_ALL 255u

/* A surface. Colours are linear RGB. Whitted's share 1 - reflect - refract is diffuse. 96 B. */
typedef struct rt_material {
    rt_f32 color[3];      /* diffuse reflectance; also tints refracted light. Of a conductor: reflectance at normal incidence */
    rt_f32 reflect;       /* 0..1, mirror share */
    rt_f32 emission[3];   /* light added at each hit; for `path` a radiance */
    rt_f32 refract;       /* 0..1, share that Fresnel's equations split into reflected and refracted light */
    rt_f32 specular[3];   /* colour of the Blinn-Phong highlight */
    rt_f32 shininess;     /* exponent of the highlight */
    rt_f32 ior;           /* index of refraction of the inside, 1.5 for glass */
    rt_u32 texture;       /* that multiplies color, by the first set of coordinates; RT_NONE: none, or one that is an rt_map */
    rt_u32 flags;         /* RT_MATERIAL_* */
    rt_u32 model;         /* RT_MODEL_*: what `path` takes the surface for. Whitted's tracers read the members above */
    rt_f32 absorption[3]; /* inside of a dielectric, per unit of length: light falls by exp(-absorption length) */
    rt_f32 roughness;     /* 0..1; GGX with alpha = roughness^2; 0: smooth */
    rt_u32 alpha;         /* RT_ALPHA_*: what becomes of the alpha, which is opacity times those of the texture and the vertices */
    rt_f32 opacity;       /* 0..1 */
    rt_f32 cutoff;        /* RT_ALPHA_MASK: where alpha is below it, there is no surface */
    rt_u32 pad;
} rt_material;
#define RT_ALPHA_OPAQUE 0u /* alpha does not count */
#define RT_ALPHA_MASK 1u
#define RT_ALPHA_BLEND 2u  /* the share of the surface that is there; through the rest one sees what is behind */

/* The values of a material that only RT_MODEL_GLTF has. There is one for each rt_material, which has color, roughness and ior. 96 B. */
typedef struct rt_layers {
    rt_f32 specular_color[3]; /* of the reflection of what is no metal, straight on */
    rt_f32 specular_weight;   /* 0..1, of that reflection */
    rt_f32 sheen_color[3];    /* of fibres on top: their reflectance */
    rt_f32 sheen_roughness;   /* 0..1 */
    rt_f32 metallic;          /* 0..1, share of metal */
    rt_f32 transmission;      /* 0..1, share of what is no metal that light goes through */
    rt_f32 clearcoat;         /* 0..1, share of the surface with a layer of varnish of ior 1.5 */
    rt_f32 clearcoat_roughness;
    rt_f32 anisotropy;          /* 0..1: the roughness along the grain grows from roughness^2 to 1 with its square */
    rt_f32 anisotropy_rotation; /* of the grain, in degrees, counter-clockwise from the tangent */
    rt_f32 iridescence;         /* 0..1, share of the surface with a thin film */
    rt_f32 iridescence_ior;     /* of the film */
    rt_f32 iridescence_thickness;     /* of the film, in nm; with a texture the greatest */
    rt_f32 iridescence_thickness_min; /* with a texture the least */
    rt_u32 flags;                     /* RT_LAYERS_* */
    rt_u32 pad[5];
} rt_layers;
#define RT_LAYERS_SOLID 1u /* the surface bounds a solid, so light that goes through is refracted; else it is a thin sheet */

/* A light. What `color` is depends on the kind: see RT_LIGHT_* in rt_shared.h. 96 B. */
typedef struct rt_light {
    rt_f32 position[3]; /* world; of an area light its middle. directional, sun: unit vector towards the light */
    rt_u32 kind;        /* RT_LIGHT_* */
    rt_f32 color[3];    /* linear RGB, intensity included */
    rt_u32 flags;       /* RT_LIGHT_FALLOFF, ... */
    rt_f32 u[3];        /* rect: from the middle to the middle of an edge */
    rt_f32 radius;      /* disc, sphere. sun: sine of the half of its angle, exact where cos_outer is next to 1 */
    rt_f32 v[3];        /* rect: as u, of an edge beside it */
    rt_f32 area;        /* rect, disc, sphere: of the side, or of both sides, that emits. sun: pi sin^2 of the half of its angle:
                         * color / area is its radiance */
    rt_f32 normal[3];   /* unit: side that a rect (u x v) or a disc emits from; axis of a spot, into which it shines */
    rt_f32 cos_inner;   /* spot: cosine of the half angle within which it has its full intensity */
    rt_f32 cos_outer;   /* spot: beyond this half angle it has none. sun: cosine of the half of its angle */
    rt_f32 inner, angle; /* degrees: whole angles of which the two cosines are, as users write them; the host's */
    rt_f32 range;       /* point, spot with falloff: there it ends; 0: nowhere */
} rt_light;

/* What emits light, for `path`: a light, an emissive primitive or the sky. The lights of the frame come first, then the sky if it
 * shines, then primitives by ascending numbers. Entry i is also cell i of a table by which an emitter is picked (Walker 1974): a number
 * below RT_PICKS has a cell in its upper bits, and picks the cell's own emitter if the rest is below `threshold`, else `alias`.
 * 32 B. */
typedef struct rt_emitter {
    rt_u32 threshold, alias;
    rt_f32 pick;     /* the probability that the table picks it, exactly; 0: never */
    rt_u32 kind;     /* RT_LIGHT_* or RT_EMITTER_* */
    rt_u32 at;       /* number of the light; position of the primitive in leaf order */
    rt_u32 instance; /* of the primitive; RT_NONE: it is in the world */
    rt_u32 leaf;     /* node of the light tree, by which it is picked; `pick` is then that of the tree. RT_NONE: the table picks it */
    rt_f32 area;     /* of a polygon, one side */
} rt_emitter;
#define RT_PICK_BITS 24u
#define RT_PICKS 16777216
#define RT_EMITTER_SURFACE RT_LIGHT_KINDS
#define RT_EMITTER_SKY (RT_LIGHT_KINDS + 1u)
#define RT_EMITTER_TREE (RT_LIGHT_KINDS + 2u) /* stands in the table for all emitters of the light tree */
/* Numbers of what shines and is no light of the frame. */
#define RT_LIGHT_OF_SURFACES 0x40000000
#define RT_LIGHT_OF_SKY 0x40000001

/* What kernels are compiled for besides shapes and attributes, as bits of RT_LIGHTS and RT_LOBES. Lights: 1 << RT_LIGHT_* or
 * 1 << RT_EMITTER_*, and whether some light has RT_LIGHT_FALLOFF. Lobes: how surfaces scatter in `path`, besides diffusely. */
#define RT_LIGHTS_FADE (1u << (RT_LIGHT_KINDS + 2u))
#define RT_LIGHTS_ALL (2u * RT_LIGHTS_FADE - 1u)
#define RT_LOBE_MIRROR 1u
#define RT_LOBE_METAL 2u
#define RT_LOBE_GLASS 4u
#define RT_LOBE_FROSTED 8u  /* rough glass */
#define RT_LOBE_ABSORBS 16u /* glass that takes light on its way through */
#define RT_LOBE_LAYERS 32u  /* RT_MODEL_GLTF; the following bits are its own */
#define RT_LOBE_COAT 64u
#define RT_LOBE_SHEEN 128u
#define RT_LOBE_THIN 256u   /* transmission by thin sheets */
#define RT_LOBE_GRAIN 512u  /* anisotropy */
#define RT_LOBE_FILM 1024u  /* iridescence */
#define RT_LOBE_CHANGED 2048u /* solid glass that reflects less or more than Fresnel's equations say */
#define RT_LOBE_UNLIT 4096u   /* RT_MODEL_UNLIT */
#define RT_LOBES_ALL 8191u
#ifdef __OPENCL_VERSION__
#ifndef RT_LIGHTS
#define RT_LIGHTS RT_LIGHTS_ALL
#endif
#ifdef RT_LOBES
#define RT_KNOWS_LOBES /* the host has said which: a program of paths */
#else
#define RT_LOBES RT_LOBES_ALL
#endif
#define RT_MAY_SHINE(kinds) ((RT_LIGHTS & (kinds)) != 0u) /* whether the scene has one of them */
#define RT_MAY_SCATTER(lobes) ((RT_LOBES & (lobes)) != 0u)
#endif
#define RT_LIGHTS_PLAIN (1u << RT_LIGHT_POINT | 1u << RT_LIGHT_DIRECTIONAL) /* without RT_LIGHTS_FADE: as Whitted has them */
#define RT_LIGHTS_POINTS (1u << RT_LIGHT_POINT | 1u << RT_LIGHT_SPOT) /* rt_intensity_share() tells them apart */
#define RT_LIGHTS_FLAT (1u << RT_LIGHT_RECT | 1u << RT_LIGHT_DISC)
#define RT_LIGHTS_SOLID (RT_LIGHTS_FLAT | 1u << RT_LIGHT_SPHERE) /* they are somewhere, with a size */
#define RT_LIGHTS_BEYOND (1u << RT_LIGHT_SUN | 1u << RT_EMITTER_SKY)
#define RT_LIGHTS_GIVEN ((1u << RT_LIGHT_KINDS) - 1u) /* lights of the frame, of any kind */

/* A node of the light tree (shading/light_tree.h): what bounds the emitters below it. They lie in a box, and shine within an angle of
 * directions that lie within an angle of an axis. 64 B. */
typedef struct rt_light_node {
    rt_f32 lower[3];
    rt_f32 intensity; /* sum of their intensities straight on, as a share of the tree's */
    rt_f32 upper[3];
    rt_f32 cos_spread; /* cosine of the angle around the axis */
    rt_f32 axis[3];    /* unit */
    rt_f32 cos_reach;  /* cosine of the angle around each direction */
    rt_u32 two_sided;  /* the same holds around the opposite axis */
    rt_u32 child;      /* number of the first of two children, which follow each other; RT_NONE: a leaf */
    rt_u32 emitter;    /* of a leaf */
    rt_u32 parent;     /* RT_NONE: the root, which is node 0 */
} rt_light_node;

/* Primitives of consecutive numbers that are emitters of consecutive numbers, as many as up to the next run's first emitter. 8 B. */
typedef struct rt_emitter_run {
    rt_u32 first_prim, first_emitter;
} rt_emitter_run;

/* The table of emitters as a whole, and the sky. 100 B. */
typedef struct rt_lighting {
    rt_u32 emitter_count, cell_bits; /* the table has 2^cell_bits entries; those beyond emitter_count are cells only */
    rt_u32 run_count;                /* another run follows these, as their end */
    rt_u32 sun_count;                /* lights that are discs on the sky */
    rt_u32 sky_emitter;              /* RT_NONE: the sky is black */
    rt_u32 sky_kind;                 /* RT_SKY_* */
    rt_u32 sky_width, sky_height;    /* of the picture, in texels */
    rt_u32 sky_hidden;               /* camera rays see `background` instead */
    rt_f32 sky_turn;                 /* by which it is turned about +Y, in turns, counter-clockwise from above */
    rt_f32 sky_color[3];             /* radiance; of a gradient at the zenith; factor of a picture */
    rt_f32 sky_horizon[3], sky_ground[3];
    rt_u32 sky_below;                /* of RT_PICKS: how many draw a direction below a gradient's horizon */
    rt_f32 sky_horizon_share;        /* of a gradient: mean color of horizon / (horizon + zenith) */
    rt_f32 background[3];
    rt_f32 sky_scale;                /* of a picture: by which its halves are multiplied */
} rt_lighting;

/* A picture in the texel buffer: width x height RGBA8, top row first, starting at texel `first`. Behind it are `levels` smaller
 * ones, each half as wide and high as the one before, rounded down, but at least 1. Several textures may show one picture. 28 B. */
typedef struct rt_texture {
    rt_u32 first, width, height;
    rt_u32 wrap;  /* outside of the picture: RT_WRAP_... of rt_plugin.h along u, plus RT_WRAP_ALONG_V times that along v */
    rt_u32 flags; /* RT_TEXTURE_... */
    rt_u32 levels;
    rt_u32 smaller; /* on a device: number of the texture that shows the first smaller picture; those of the others follow */
} rt_texture;
#define RT_WRAP_ALONG_V 4u
#define RT_TEXTURE_LINEAR 1u  /* its texels are numbers of 0..1; else r, g and b are sRGB */
#define RT_TEXTURE_NEAREST 2u /* shows the nearest texel; else texels are interpolated */

/* One use of a texture by a material. 40 B. */
typedef struct rt_map {
    rt_f32 matrix[6]; /* 2x3, row-major: from the surface's coordinates to the texture's. (0, 0) is at the bottom left */
    rt_u32 texture;
    rt_u32 set;       /* of the surface's coordinates: 0 or 1 */
    rt_f32 scale;     /* RT_MAP_NORMAL: of x and y; RT_MAP_OCCLUSION: its strength; else 1 */
    rt_u32 pad;
} rt_map;

/* The surfaces that a ray may pass one after the other (shading/cutouts.h). The next one stops it, and the ray counts as
 * dropped. */
#define RT_MOST_PASSED 1024u

#define RT_MOST_NUMBERS 16

/* Values that may change from frame to frame while program and scene stay the same. 304 B. */
typedef struct rt_frame {
    rt_f32 eye[3];
    rt_f32 pixel_x;  /* 1 / width of the whole picture. A ray's direction has 2 (x + within_x) pixel_x - 1 of `right` */
    rt_f32 right[3]; /* unit vector to the right * tan(fov / 2) * width / height */
    rt_f32 pixel_y;  /* 1 / height of the whole picture */
    rt_f32 up[3];    /* unit vector upwards * tan(fov / 2) */
    rt_u32 width;
    rt_f32 forward[3]; /* unit */
    rt_u32 height;
    rt_f32 background[3];
    rt_u32 depth; /* generations of rays, 1 = camera rays only */
    rt_f32 ambient[3];
    rt_u32 light_count;
    rt_u32 plane_count;
    rt_u32 sample; /* number of this sample */
    rt_u32 adds;   /* 0: the sample replaces what is in the film; else it is added */
    rt_u32 layers; /* samples of the launch, this one first, each into a film of its own; so many rt_frame follow each other */
    rt_u32 packet_w, packet_h;    /* pixels of one work-item */
    rt_u32 shadows;               /* 0: no shadow rays */
    rt_u32 aov;                   /* what aov.cl writes: RT_AOV_T, ... */
    rt_u32 root;                  /* root of group 0's tree */
    rt_u32 block_w, block_w_log2; /* width of a block in pixels; a block has RT_LANES pixels, traced together */
    rt_u32 blocks_x, blocks_y;    /* blocks that cover a packet */
    rt_f32 within_x, within_y;    /* the point of each pixel through which this sample's rays go, 0..1 */
    rt_u32 row_count; /* 0: all rows of work-groups. Else this many rows, and their numbers follow the last rt_frame as uints */
    rt_f32 bounds[6]; /* of all primitives but planes: lower x, y, z, upper x, y, z. If there are none: inf, -inf */
    rt_u32 first_x, first_y; /* the film is a part of the whole picture: its first pixel there */
    rt_u32 whole_width;      /* of the whole picture */
    rt_u32 samples;    /* `path`: of this launch, this one first; they are added to the film in their order */
    rt_u32 path_flags; /* RT_PATH_* */
    rt_f32 focus;          /* thin lens: distance along `forward` that is sharp */
    rt_f32 lens_x, lens_y; /* radius of the lens by the lengths of right and up; 0: a pinhole */
    /* The paths that count (--only-paths); RT_NONE: all. */
    rt_u32 only_by;     /* RT_BY_* */
    rt_u32 only_first;  /* RT_FIRST_*, of the first event */
    rt_u32 ray_mask;    /* of the rays of a query: RT_SEEN_BY_* and other bits */
    rt_u32 pad[3];
    rt_u32 numbers[RT_MOST_NUMBERS]; /* settings that kernels read by their keys: RT_SETTING(frame, key) */
} rt_frame;
/* How a path came to its light: by a point that was drawn on it, or by the ray of a surface or the camera. */
#define RT_BY_NEE 0u
#define RT_BY_BSDF 1u
/* How the first surface scattered. A smooth or rough mirror is glossy. */
#define RT_FIRST_DIFFUSE 0u
#define RT_FIRST_GLOSSY 1u
#define RT_FIRST_TRANSMISSION 2u
#define RT_PATH_SOBOL 1u          /* samples are Sobol's points, scrambled; else independent */
#define RT_PATH_DRAWS_LIGHTS 2u   /* points of lights that have a size are drawn: strategies nee and mis */
#define RT_PATH_FINDS_LIGHTS 4u   /* rays of rough surfaces count lights that they find: strategies bsdf and mis */
#define RT_PATH_POWER_WEIGHTS 8u  /* of both: weights of squared densities */
#define RT_PATH_GAUSSIAN 16u      /* pixels are weighted by a Gaussian; else all points of a pixel count alike */

/* A ray and its answer, for tests and benches that trace rays of their own. 32 B each. Kernels read and write blocks of
 * RT_LANES of them, field by field: cl/tracers/rays/ray_blocks.h. */
typedef struct rt_ray {
    rt_f32 origin[3], t_min, direction[3], t_max;
} rt_ray;
typedef struct rt_hit {
    rt_f32 t, u, v;  /* t = INFINITY: no hit. Any-hit queries: t = 0 where occluded */
    rt_i32 prim;     /* -1: no hit */
    rt_i32 instance; /* -1: not instanced */
    /* Counted on request. Each ray of a block of RT_LANES has the sums over the block. */
    rt_u32 steps;      /* nodes visited */
    rt_u32 leaf_tests; /* primitives tested, without planes */
    rt_u32 lane_steps; /* sum over the nodes visited: rays that enter the node */
} rt_hit;
#define RT_RAY_FIELDS 8u

/* What programs with RT_COUNT_STEPS count, a row each: its name, and what becomes of two counts of one ray.
 *   MEAN      they are added; a packet whose rays are traced one by one has their mean, rounded up
 *   SUM       they are added, over the rays of a packet, too
 *   GREATEST  the greater one stays
 * The host's helpers count the first ones for a query (RT_HOST_COUNT), for the counter of the hit that stands behind. `own`: as the
 * structure's traversal reports it. */
#define RT_HELPER_COUNTERS(ROW) ROW(nodes, MEAN, steps) ROW(boxes, MEAN, boxes) ROW(tests, MEAN, leaf_tests)
#define RT_HIT_COUNTERS(ROW)                                                                                                   \
    ROW(steps, MEAN, )     /* nodes visited: by the helpers, else by the traversal */                                          \
    ROW(leaf_tests, MEAN, )                                                                                                    \
    ROW(lane_steps, SUM, ) /* rays that enter a node */                                                                        \
    ROW(boxes, MEAN, )                                                                                                         \
    ROW(own_steps, MEAN, ) /* of `steps` */                                                                                    \
    ROW(own_boxes, MEAN, ) /* beside `boxes` */                                                                                \
    ROW(own_tests, MEAN, ) /* beside `leaf_tests` */                                                                           \
    ROW(visits, MEAN, )    /* nodes, by the traversal */
#define RT_COUNTER_MEMBER(name, how, of_hit) rt_u32 name;
#define RT_COUNTER_ONE(name, how, of_hit) +1u
#define RT_HIT_COUNTER_COUNT (0u RT_HIT_COUNTERS(RT_COUNTER_ONE))

/* Planes of a film of colours, of a float4 a pixel. All films have the first one, those of `path` the first two (tracers/path/sum.h), and
 * those with the denoiser's guides all (tracers/path/guides.h). */
#define RT_PLANE_SUM 0u
#define RT_PLANE_REST 1u
#define RT_PLANE_OWN 2u
#define RT_PLANE_ALBEDO 3u
#define RT_PLANE_NORMAL 4u
#define RT_FILM_PLANES 5u

/* Generations of rays that a picture may have. */
#define RT_MOST_DEPTH 128u
/* Of the tracer `wavefront`: 32-bit numbers that control a level (a generation, and one that is never traced), and that hold the light
 * which deferred paths add to a pixel. */
#define RT_CONTROL 2u
#define RT_CONTROLS ((RT_MOST_DEPTH + 1u) * RT_CONTROL)
#define RT_SHARE 6u

/* Numbers of fields of an answer: see ray_blocks.h. */
#define RT_ANSWER_OCCLUSION 1u
#define RT_ANSWER_NEAREST 2u
#define RT_ANSWER_HIT 4u
#define RT_ANSWER_PLACED 5u
#define RT_LIST_FIELDS 5u /* of a place in a list of all hits: t, u, v, prim, instance */

/* One ray of the tree of rays that give a pixel its colour. 96 B. */
typedef struct rt_ray_record {
    rt_f32 origin[3], t; /* +inf: no hit; shadow rays: distance of the light */
    rt_f32 direction[3];
    rt_u32 kind; /* RT_RAY_* */
    rt_f32 weight[3];
    rt_u32 fate;                                          /* RT_FATE_* */
    rt_f32 light[3];                                      /* light that the ray adds to the pixel */
    rt_u32 generation;                                    /* 1: camera rays */
    rt_i32 parent, prim, instance, material, light_index; /* -1: none */
    rt_u32 occluded, steps, leaf_tests;
} rt_ray_record;
#define RT_RAY_CAMERA 0u
#define RT_RAY_MIRROR 1u
#define RT_RAY_REFRACTED 2u
#define RT_RAY_SHADOW 3u
#define RT_FATE_TRACED 0u
#define RT_FATE_DROPPED 1u   /* no ray slot left */
#define RT_FATE_TOO_LIGHT 2u /* below min_weight */
#define RT_FATE_TOO_DEEP 3u  /* beyond the last generation */
#define RT_FATE_UNASKED 4u   /* shadows are off */
#endif
