/* path_record.h -- what the replay of a pixel writes of each path. Kernels and host share it. */
#ifndef RT_PATH_RECORD_H
#define RT_PATH_RECORD_H

/* One record of a path: where it begins, an event of scattering, or light that counts. The records of a sample are in the order
 * of the path. 80 B. */
typedef struct rt_path_record {
    rt_f32 at[3];     /* the camera, the surface or the point of the light; of light beyond everything, the direction towards it */
    rt_u32 kind;      /* RT_PATH_BEGINS, ... */
    rt_f32 weight[3]; /* throughput: of an event behind it, of light before it */
    rt_u32 bounce;    /* events between the camera and this record; an event counts itself */
    rt_f32 light[3];  /* what the pixel's sample gets; 0 of events */
    rt_f32 mis;       /* weight of the strategy that brought the light, between 0 and 1 */
    rt_f32 pdf, other_pdf; /* of the direction: by what drew it, and by the other strategy; 0: it cannot, or there was no choice */
    rt_u32 how;       /* of an event RT_FIRST_*, of light RT_BY_* */
    rt_i32 light_number; /* as --only-paths light; -1 of events */
    rt_i32 material;  /* of the surface of an event, or that shines by itself; -1: none */
    rt_u32 first;     /* of light: RT_FIRST_* of the first event; RT_PATH_NO_EVENT */
    rt_u32 flags;     /* RT_PATH_* below */
    rt_u32 unused;
} rt_path_record;

#define RT_PATH_BEGINS 0u
#define RT_PATH_SCATTERS 1u
#define RT_PATH_LIT 2u
#define RT_PATH_NO_EVENT 0xffffffffu
#define RT_PATH_BEYOND 1u /* the light is of a sky or a sun */
#define RT_PATH_SMOOTH 2u /* of an event: by a smooth mirror or glass, which leaves no choice */
#define RT_PATH_ENDS 4u   /* of an event: the path does not go on */

/* The most records of a sample: the camera's, and of each ray two kinds of light it may find, an event, and light drawn there. */
#define RT_MOST_PATH_RECORDS(depth) (1u + 4u * ((depth) + 1u))

#endif
