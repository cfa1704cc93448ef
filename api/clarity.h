/* clarity.h -- Clarity as a library: scenes, ray queries and pictures from C, and through it from other languages. C99.
 *
 * - A function returns CLARITY_OK or another code below. After another code clarity_error_text() tells what was tried, why it failed
 *   and what to do, and results are as they were before the call; arrays of more than 1,024 rays may have the first hits of a call that
 *   was cancelled or failed on the way. Nothing is printed and nothing ends the process.
 * - Texts are UTF-8. Devices, structures and settings are the texts of the command line: "gpu", "bvh4,max_leaf=4", "spp=16".
 * - A struct begins with its size in bytes, which the caller sets: sizeof of the caller's header. Later versions append fields, and 0 in
 *   a field means what it meant before the field was there. So set the other fields to 0 first.
 * - Threads: each handle works for one thread at a time, and a second one waits. Different handles work at the same time.
 * - The library starts the program `clarity` for work that may crash, such as imports. It looks for it in its own folder, in ../bin and
 *   in ../../bin; clarity_set_program() or the variable CLARITY_WORKER name another one. Before drivers of OpenCL are loaded, it sets the
 *   variable POCL_CACHE_DIR of this process.
 * - After fork() the child gets CLARITY_FORKED from each call if the parent has used the library: drivers do not survive a fork. Start
 *   another program instead (in Python: multiprocessing with "spawn"). Calls of clarity_set_program() and
 *   clarity_set_log() are no such use.
 * - Functions of the caller, which hear of progress, rows and the log, get CLARITY_USAGE from each call: the library waits for them.
 * - A process that ends while other threads trace calls clarity_end() first. */
#ifndef CLARITY_H
#define CLARITY_H
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Codes: those up to 5 are also the program's exit codes. */
enum {
    CLARITY_OK = 0,
    CLARITY_FAILED = 1,
    CLARITY_USAGE = 2, /* a mistake of the caller: an unknown setting, a null pointer */
    CLARITY_NO_DEVICE = 3,
    CLARITY_IMPORT_FAILED = 4,
    CLARITY_KERNEL_BUILD_FAILED = 5,
    CLARITY_FORKED = 6,
    CLARITY_ENDED = 7, /* another thread has called clarity_end() */
    CLARITY_CANCELLED = 130
};
enum { CLARITY_FLOAT32 = 0, CLARITY_FLOAT64 = 1 };                                             /* types of numbers in arrays */
/* Arrays of hits, as in clarity_hits. */
enum { CLARITY_HIT_T = 0, CLARITY_HIT_PRIM = 1, CLARITY_HIT_UV = 2, CLARITY_HIT_INSTANCE = 3 };
enum { CLARITY_LOG_DEBUG = 0, CLARITY_LOG_INFO = 1, CLARITY_LOG_WARNING = 2, CLARITY_LOG_ERROR = 3 };

typedef struct clarity_scene clarity_scene;   /* what files or arrays describe */
typedef struct clarity_tracer clarity_tracer; /* a scene in a structure on a device; keeps the scene alive */
typedef struct clarity_packed clarity_packed; /* rays that lie on a device */
typedef struct clarity_kept clarity_kept;     /* hits that lie on a device until they are read */

/* Of long calls; NULL: nobody watches. */
typedef struct clarity_watch {
    uint32_t struct_bytes;
    uint32_t unused;
    /* Told what is done, "building bvh4", and how much of it, 0 to 1, or a negative number: not known. Returns 0 to cancel the call.
     * Called from any thread, one call at a time; it must not call the library. May be NULL. */
    int32_t (*progress)(void *user, const char *stage, float fraction);
    void *user;
    /* The call is cancelled once another number than 0 is here, which another thread or a signal handler may write. May be NULL. */
    const volatile int32_t *cancel;
} clarity_watch;

/* Triangles. The scene reads the arrays until it and all tracers of it are freed: they must not change or go before. Positions of
 * type CLARITY_FLOAT64 are copied during the call: they lie far from 0 where they need it, without a loss of digits. Coordinates
 * beyond 1e15 (float64: of the place that is subtracted) and a mesh smaller than 1e-17 are refused. */
typedef struct clarity_mesh {
    uint32_t struct_bytes;
    int32_t type; /* of positions */
    uint64_t vertex_count;
    uint64_t triangle_count;
    const void *positions;     /* x, y, z of each vertex */
    const uint32_t *triangles; /* three vertices each */
} clarity_mesh;

typedef struct clarity_options {
    uint32_t struct_bytes;
    uint32_t unused;
    const char *device;          /* as --device; NULL or "": CLARITY_DEVICE, or else the best one */
    const char *accel;           /* as --accel; NULL or "": the best one for the device */
    const char *const *settings; /* "key=value" as --set, with NULL behind the last; or NULL */
} clarity_options;

/* Rays in arrays of any steps. A step is in bytes: from one ray to the next, and from x to y to z. A step of 0 gives all rays the same. */
typedef struct clarity_rays {
    uint32_t struct_bytes;
    int32_t type; /* of all four arrays */
    uint64_t count;
    const void *origins; /* in the coordinates of the files, also far from 0 */
    /* A ray hits nothing if its direction is zero, or not finite in single precision, or has no component of at least 2^-60. Any other
     * length is right, and t counts in it. */
    const void *directions;
    const void *t_min; /* NULL: 0 */
    const void *t_max; /* NULL: infinity */
    int64_t origin_steps[2];
    int64_t direction_steps[2];
    int64_t t_min_step;
    int64_t t_max_step;
    uint32_t mask; /* 1 to 255: the rays hit only instances that share a bit of it with their mask; 0: all instances that rays see */
    uint32_t unused;
    const clarity_packed *packed; /* or NULL. Otherwise `count` is its, and no array is read */
} clarity_rays;

/* Where hits go: arrays of `count` elements without gaps. NULL: not wanted; t and prim alone are found faster. */
typedef struct clarity_hits {
    uint32_t struct_bytes;
    uint32_t unused;
    float *t;          /* in lengths of the direction; infinity: nothing is hit */
    int32_t *prim;     /* number of the primitive, counted through all instances; -1: nothing is hit */
    int32_t *instance; /* -1: none, or not known */
    float *uv;         /* two a ray: weights of the triangle's second and third corner */
} clarity_hits;

/* All hits of rays, ordered by ray, then by t, then by primitive. clarity_all() writes the members behind `unused`; the arrays live
 * until clarity_all_hits_free(). */
typedef struct clarity_all_hits {
    uint32_t struct_bytes;
    uint32_t unused;
    uint64_t count;
    const int64_t *first; /* one more than there are rays: the hits of ray i are first[i] to first[i + 1] - 1 */
    const int64_t *ray;   /* `count` elements, as of the arrays below */
    const float *t;
    const int32_t *prim;
    const int32_t *instance;
    const float *uv;
    void *owner; /* of the arrays */
} clarity_all_hits;

/* Where vertices and instances are. The arrays are copied. */
typedef struct clarity_places {
    uint32_t struct_bytes;
    int32_t type;          /* of both arrays */
    const void *positions; /* of a scene of clarity_scene_from_mesh(): x, y, z of each vertex; NULL: they stay */
    uint64_t vertex_count;
    const void *transforms; /* of each instance: world from object, three rows of four numbers; NULL: they stay */
    uint64_t instance_count;
} clarity_places;

/* A picture. Rows follow each other without gaps, the top row first. */
typedef struct clarity_picture {
    uint32_t struct_bytes;
    uint32_t channels;           /* written by the call: 3 for colours and vectors, else 1 */
    const char *const *settings; /* as in clarity_options: "size=640x480", "spp=16", "aov=t"; also words for lights and materials */
    const char *camera;          /* as --camera; may be NULL */
    const char *light;           /* as --light; may be NULL */
    uint64_t room;               /* floats at `pixels` */
    float *pixels;               /* NULL: only the members that the call writes are wanted */
    uint32_t width;              /* written by the call */
    uint32_t height;
} clarity_picture;

/* Of the library; the second is SHA-256 of this file, for bindings that are made from it. */
const char *clarity_version(void);
const char *clarity_header_digest(void);

/* Of the last call on this thread that failed; valid until the next call on it. Details are texts of several lines, such as a
 * compiler's log; "" if there are none. */
const char *clarity_error_text(void);
const char *clarity_error_details(void);

/* The program `clarity`; before all other calls but the above. */
int32_t clarity_set_program(const char *path);
/* A digest of bytes as text: 32 digits in hexadecimal and a 0. Equal bytes have equal digests. It is found about as fast as memory is
 * read: so a caller who was lent an array can tell later whether it is as it was. */
int32_t clarity_digest(const void *bytes, uint64_t count, char digest[33]);
/* Gets the lines of the log, from any thread, those of CLARITY_LOG_DEBUG too. NULL: nobody does. */
int32_t clarity_set_log(void (*log)(void *user, int32_t level, const char *text), void *user);
/* Before a process ends whose other threads may be in a call: cancels these calls and waits for them, 10 s at most. Further calls of
 * other threads return CLARITY_ENDED, and what they free stays. This thread may go on. */
int32_t clarity_end(void);

int32_t clarity_scene_load(const char *const *files, uint64_t count, const clarity_watch *watch, clarity_scene **scene);
int32_t clarity_scene_from_mesh(const clarity_mesh *mesh, const clarity_watch *watch, clarity_scene **scene);
void clarity_scene_free(clarity_scene *scene);
/* What `clarity info --json` prints, warnings included. Valid until the scene is freed. */
int32_t clarity_scene_info(const clarity_scene *scene, const char **json);
/* The box of everything finite, in the coordinates of the files. Without such things lo is infinity and hi is -infinity. */
int32_t clarity_scene_bounds(const clarity_scene *scene, double lo[3], double hi[3]);

int32_t clarity_tracer_new(const clarity_scene *scene, const clarity_options *options, const clarity_watch *watch, clarity_tracer **tracer);
void clarity_tracer_free(clarity_tracer *tracer);
/* As JSON: its device and structure, as the keys of `clarity render --stats` say, and of its ray queries so far `rays`, `device_ms`, and
 * `bytes_to_device` and `bytes_from_device`, which were copied for them. Valid until this thread asks for it again, or the tracer's end. */
int32_t clarity_tracer_info(clarity_tracer *tracer, const char **json);
int32_t clarity_closest(clarity_tracer *tracer, const clarity_rays *rays, const clarity_hits *hits, const clarity_watch *watch);
/* Rays that are traced often: they are read from the arrays once, and stay on the tracer's device, 32 bytes each. They serve
 * clarity_closest() and clarity_any() of this tracer. */
int32_t clarity_pack(clarity_tracer *tracer, const clarity_rays *rays, const clarity_watch *watch, clarity_packed **packed);
void clarity_packed_free(clarity_packed *packed);
/* Hits of a tracer that stay where they were found, so that only those arrays are copied that somebody asks for, and none on a CPU.
 * brief: not 0 if only t and prim are wanted, which are found faster. They keep their device open, also after the tracer was freed.
 * Where all kept hits of a tracer would take more than a quarter of the device's memory, clarity_keep() copies the new ones. */
int32_t clarity_kept_new(const clarity_tracer *tracer, int32_t brief, clarity_kept **kept);
void clarity_kept_free(clarity_kept *kept);
/* Finds them, as clarity_closest(). Those of an earlier call are gone: arrays of them that were asked for have the new ones when this
 * call returns, and so must be as many. After a call that failed there are none until the next one. */
int32_t clarity_keep(clarity_tracer *tracer, const clarity_rays *rays, clarity_kept *kept, const clarity_watch *watch);
/* One array, CLARITY_HIT_*, as in clarity_hits. The caller may write to it. It stays where it is until clarity_kept_free(). */
int32_t clarity_kept_array(clarity_kept *kept, int32_t which, void **array);
/* 1 for rays that hit anything between t_min and t_max, else 0. */
int32_t clarity_any(clarity_tracer *tracer, const clarity_rays *rays, uint8_t *occluded, const clarity_watch *watch);
/* Moves what this tracer traces; its scene stays as it is for others. The structure is refitted where it can follow, and built anew
 * where it cannot or where rays have become dear, as the setting `poses` says. A failed or cancelled call moves nothing. */
int32_t clarity_move(clarity_tracer *tracer, const clarity_places *places, const clarity_watch *watch);
/* How many hits each ray has with t_min <= t < t_max, not only the nearest: a triangle is hit once, a sphere on both sides. */
int32_t clarity_count(clarity_tracer *tracer, const clarity_rays *rays, int64_t *counts, const clarity_watch *watch);
/* Which they are. Rays with many hits need much memory: 40 bytes a hit. */
int32_t clarity_all(clarity_tracer *tracer, const clarity_rays *rays, clarity_all_hits *hits, const clarity_watch *watch);
void clarity_all_hits_free(clarity_all_hits *hits); /* sets the members to 0 that clarity_all() has written */
/* Renders as `clarity render` does; the pixels are those of its .pfm, the top row first. Settings of the tracer hold, too. */
int32_t clarity_render(clarity_tracer *tracer, clarity_picture *picture, const clarity_watch *watch);
/* What `clarity bench` or `clarity check` finds, each row as JSON in one line, in the order of their --json. words: of the command
 * line, with NULL behind the last: "check", "./my_tree.so", "--quick". They run in a process of their own, which a plugin may crash.
 * Rows tell for themselves whether they passed: the call works if there are rows. */
int32_t clarity_rows(const char *const *words, void (*row)(void *user, const char *json), void *user, const clarity_watch *watch);

#ifdef __cplusplus
}
#endif
#endif
