/* query_tests.c -- hits, lists of hits, packed rays, moves, and rows of processes. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "fixtures.h"

/* Hits of the square by rays in a struct of the caller's, by all numbers of lanes. */
void test_rays(const clarity_scene* scene, const char* accel, const char* lanes) {
    struct ray {
        float direction[3], label, t_max, origin[3];
    } rays[3] = {{{0, 0, -2}, 0, INFINITY, {0.75f, 0.25f, 4}}, {{0, 0, -2}, 0, 1.5f, {0.75f, 0.25f, 4}}, {{0, 0, -2}, 0, 9, {3, 0, 4}}};
    const char* const settings[] = {lanes, NULL};
    const clarity_options options = options_of(accel, settings);
    clarity_tracer* tracer = NULL;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    clarity_rays query = {0};
    query.struct_bytes = sizeof query;
    query.count = 3;
    query.origins = rays[0].origin;
    query.directions = rays[0].direction;
    query.t_max = &rays[0].t_max;
    query.origin_steps[0] = query.direction_steps[0] = query.t_max_step = sizeof rays[0];
    query.origin_steps[1] = query.direction_steps[1] = sizeof(float);
    float t[3], uv[6];
    int32_t prim[3], instance[3];
    uint8_t occluded[3] = {9, 9, 9};
    clarity_hits hits = hits_into(t, prim, instance, uv);
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t[0] == 2 && prim[0] == 0 && fabsf(uv[0] - 0.5f) < 1e-6f && fabsf(uv[1] - 0.25f) < 1e-6f);
    CHECK(isinf(t[1]) && prim[1] == -1 && isinf(t[2]) && prim[2] == -1);
    WORKS(clarity_any(tracer, &query, occluded, NULL));
    CHECK(occluded[0] == 1 && occluded[1] == 0 && occluded[2] == 0);

    /* Doubles, z before y before x, and one direction for all. */
    const double backwards[] = {4, 0.25, 0.75, 3.5, 0.5, 0.5, 2.5, 0.5, 0.5}, down[] = {0, 0, -2}, t_min = 1.5, t_max = 2.5;
    query.type = CLARITY_FLOAT64;
    query.count = 3;
    query.origins = backwards + 2;
    query.origin_steps[0] = 3 * sizeof(double);
    query.origin_steps[1] = -(int64_t)sizeof(double);
    query.directions = down;
    query.direction_steps[0] = 0;
    query.direction_steps[1] = sizeof(double);
    query.t_min = &t_min;
    query.t_max = &t_max;
    query.t_min_step = query.t_max_step = 0;
    hits = hits_into(t, NULL, NULL, NULL);
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t[0] == 2 && t[1] == 1.75f && isinf(t[2]));

    query.type = 5;
    FAILS(clarity_closest(tracer, &query, &hits, NULL), CLARITY_USAGE, "unknown type 5");
    query.type = CLARITY_FLOAT64;
    query.directions = NULL;
    FAILS(clarity_any(tracer, &query, occluded, NULL), CLARITY_USAGE, "no directions");
    query.directions = down;
    FAILS(clarity_any(tracer, &query, NULL, NULL), CLARITY_USAGE, "`occluded` is null");
    FAILS(clarity_closest(tracer, NULL, &hits, NULL), CLARITY_USAGE, "clarity_rays is null");
    FAILS(clarity_closest(NULL, &query, &hits, NULL), CLARITY_USAGE, "`tracer` is null");
    query.count = 0;
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    clarity_tracer_free(tracer);
}

/* A square of 1 at 5e6: floats there have steps of a half. */
void test_far(void) {
    double positions[12], lo[3], hi[3];
    for (int i = 0; i < 12; ++i) positions[i] = square[i] + 5e6;
    const clarity_mesh mesh = mesh_of(CLARITY_FLOAT64, positions);
    clarity_scene* scene = NULL;
    clarity_tracer* tracer = NULL;
    WORKS(clarity_scene_from_mesh(&mesh, NULL, &scene));
    memset(positions, 0, sizeof positions); /* they were copied */
    WORKS(clarity_scene_bounds(scene, lo, hi));
    CHECK(lo[0] == 5e6 && hi[1] == 5e6 + 1 && hi[2] == 5e6);
    const clarity_options options = options_of("bvh2", NULL);
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    const double origin[] = {5e6 + 0.125, 5e6 + 0.0625, 5e6 + 0.375}, direction[] = {0, 0, -1};
    clarity_rays query = {0};
    query.struct_bytes = sizeof query;
    query.type = CLARITY_FLOAT64;
    query.count = 1;
    query.origins = origin;
    query.directions = direction;
    query.origin_steps[1] = query.direction_steps[1] = sizeof(double);
    float t = 0, uv[2];
    const clarity_hits hits = hits_into(&t, NULL, NULL, uv);
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t == 0.375f && fabsf(uv[0] - 0.0625f) < 1e-6f && fabsf(uv[1] - 0.0625f) < 1e-6f);
    clarity_scene_free(scene); /* the tracer keeps what it needs */
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    clarity_tracer_free(tracer);
}

/* The square, at z = 0, is lifted by its vertices, and then by its instance. */
void test_move(const clarity_scene* scene) {
    const clarity_options options = options_of("bvh2", NULL);
    clarity_tracer* tracer = NULL;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    const float origin[] = {0.75f, 0.25f, 4}, direction[] = {0, 0, -1};
    float t = 0, positions[12];
    clarity_rays query = one_ray(origin, direction);
    const clarity_hits hits = hits_into(&t, NULL, NULL, NULL);
    clarity_places places = {0};
    for (int i = 0; i < 12; ++i) positions[i] = square[i] + (i % 3 == 2 ? 1 : 0);
    places.positions = positions;
    places.vertex_count = 4;
    FAILS(clarity_move(tracer, &places, NULL), CLARITY_USAGE, "clarity_places::struct_bytes");
    places.struct_bytes = sizeof places;
    WORKS(clarity_move(tracer, &places, NULL));
    memset(positions, 0, sizeof positions); /* they were copied */
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t == 3);
    const double lifted[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5};
    places.type = CLARITY_FLOAT64;
    places.positions = NULL;
    places.transforms = lifted;
    places.instance_count = 1;
    WORKS(clarity_move(tracer, &places, NULL));
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t == 2.5f);
    places.type = 9;
    FAILS(clarity_move(tracer, &places, NULL), CLARITY_USAGE, "unknown type 9");
    places.type = CLARITY_FLOAT64;
    places.instance_count = 2;
    FAILS(clarity_move(tracer, &places, NULL), CLARITY_USAGE, "nothing was moved");
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t == 2.5f);
    clarity_tracer_free(tracer);
}

/* A move is cancelled, too, if nothing has to be done for it: after some moves no copy of the structure differs. */
void test_move_cancelled(const clarity_scene* scene) {
    const clarity_options options = options_of("bvh2", NULL);
    clarity_tracer* tracer = NULL;
    clarity_places places = {0};
    clarity_watch watch = {0};
    int32_t cancel = 1;
    places.struct_bytes = sizeof places;
    watch.struct_bytes = sizeof watch;
    watch.cancel = &cancel;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    for (int i = 0; i < 5; ++i) {
        CHECK(clarity_move(tracer, &places, &watch) == CLARITY_CANCELLED);
        WORKS(clarity_move(tracer, &places, NULL));
    }
    clarity_tracer_free(tracer);
}

static void on_row(void* user, const char* json) {
    if (strstr(json, "\"status\":\"passed\"") && !strchr(json, '\n')) ++*(int*)user;
}

/* Rows of a process of its own. */
void test_rows(void) {
    int rows = 0;
    const char* words[] = {"check", "bvh2", "--quick", "--only", "builds.parameters", NULL};
    WORKS(clarity_rows(words, on_row, &rows, NULL));
    CHECK(rows == 1);
    WORKS(clarity_rows(words, NULL, NULL, NULL));
    words[1] = "no_such_plugin";
    FAILS(clarity_rows(words, on_row, &rows, NULL), CLARITY_USAGE, "no_such_plugin: no plugin of this id");
    words[0] = "info";
    FAILS(clarity_rows(words, on_row, &rows, NULL), CLARITY_USAGE, "clarity bench");
    FAILS(clarity_rows(NULL, on_row, &rows, NULL), CLARITY_USAGE, "`words` is null");
    int32_t cancel = 1;
    clarity_watch watch = {0};
    watch.struct_bytes = sizeof watch;
    watch.cancel = &cancel;
    words[0] = "check";
    words[1] = "bvh2";
    CHECK(clarity_rows(words, on_row, &rows, &watch) == CLARITY_CANCELLED && rows == 1);
}

/* Hits that stay where they were found: those of clarity_closest(), also after their tracer is gone, and only what is read is copied. */
void test_kept(const clarity_scene* scene, const char* lanes) {
    enum { COUNT = 50001 };
    const char* const settings[] = {lanes, NULL};
    const clarity_options options = options_of("bvh2", settings);
    clarity_tracer *tracer = NULL, *other = NULL;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    WORKS(clarity_tracer_new(scene, &options, NULL, &other));
    float* const origins = malloc(3 * COUNT * sizeof(float));
    float* const t = malloc(COUNT * sizeof(float));
    float* const uv = malloc(2 * COUNT * sizeof(float));
    int32_t* const prim = malloc(COUNT * sizeof(int32_t));
    int32_t* const instance = malloc(COUNT * sizeof(int32_t));
    const float direction[] = {0, 0, -2};
    for (int i = 0; i < COUNT; ++i) {
        origins[3 * i] = 1.5f * (float)i / COUNT;
        origins[3 * i + 1] = (float)(i % 77) / 77;
        origins[3 * i + 2] = 4 + (float)(i % 5);
    }
    clarity_rays query = one_ray(origins, direction);
    query.count = COUNT;
    query.origin_steps[0] = 3 * sizeof(float);
    for (int32_t brief = 0; brief < 2; ++brief) {
        clarity_kept* kept = NULL;
        void *of_t = NULL, *of_prim = NULL, *of_uv = NULL, *of_instance = NULL, *again = NULL;
        WORKS(clarity_kept_new(tracer, brief, &kept));
        FAILS(clarity_kept_array(kept, CLARITY_HIT_T, &of_t), CLARITY_USAGE, "no hits");
        FAILS(clarity_keep(other, &query, kept, NULL), CLARITY_USAGE, "another tracer");
        for (int turn = 0; turn < 2; ++turn) {
            const clarity_hits hits = hits_into(t, prim, instance, uv);
            WORKS(clarity_closest(tracer, &query, &hits, NULL));
            WORKS(clarity_keep(tracer, &query, kept, NULL));
            if (turn == 0) { /* later they are filled without being asked for */
                WORKS(clarity_kept_array(kept, CLARITY_HIT_T, &of_t));
                WORKS(clarity_kept_array(kept, CLARITY_HIT_PRIM, &of_prim));
                WORKS(clarity_kept_array(kept, CLARITY_HIT_UV, &of_uv));
                WORKS(clarity_kept_array(kept, CLARITY_HIT_INSTANCE, &of_instance));
            }
            CHECK(memcmp(of_t, t, COUNT * sizeof *t) == 0 && memcmp(of_prim, prim, COUNT * sizeof *prim) == 0);
            CHECK(memcmp(of_instance, instance, COUNT * sizeof *instance) == 0);
            if (brief)
                CHECK(((const float*)of_uv)[0] == 0 && ((const float*)of_uv)[2 * COUNT - 1] == 0);
            else
                CHECK(memcmp(of_uv, uv, 2 * COUNT * sizeof *uv) == 0);
            for (int i = 0; i < COUNT; ++i) origins[3 * i + 2] += 1; /* of the second turn */
        }
        query.count = COUNT - 1;
        FAILS(clarity_keep(tracer, &query, kept, NULL), CLARITY_USAGE, "arrays are in use");
        query.count = COUNT;
        int32_t cancel = 1;
        clarity_watch watch = {0};
        watch.struct_bytes = sizeof watch;
        watch.cancel = &cancel;
        CHECK(clarity_keep(tracer, &query, kept, &watch) == CLARITY_CANCELLED);
        FAILS(clarity_kept_array(kept, CLARITY_HIT_T, &again), CLARITY_USAGE, "failed or was cancelled");
        WORKS(clarity_keep(tracer, &query, kept, NULL));
        WORKS(clarity_kept_array(kept, CLARITY_HIT_T, &again));
        CHECK(again == of_t);
        FAILS(clarity_kept_array(kept, 4, &again), CLARITY_USAGE, "no array 4");
        FAILS(clarity_kept_array(NULL, CLARITY_HIT_T, &again), CLARITY_USAGE, "`kept` is null");
        clarity_kept_free(kept);
    }
    clarity_kept *none = NULL, *late = NULL;
    void* of_t = NULL;
    WORKS(clarity_kept_new(tracer, 0, &none));
    query.count = 0;
    WORKS(clarity_keep(tracer, &query, none, NULL));
    WORKS(clarity_kept_array(none, CLARITY_HIT_T, &of_t));
    query.count = COUNT;
    WORKS(clarity_kept_new(tracer, 1, &late));
    WORKS(clarity_keep(tracer, &query, late, NULL));
    const clarity_hits hits = hits_into(t, NULL, NULL, NULL);
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    clarity_tracer_free(tracer);
    WORKS(clarity_kept_array(late, CLARITY_HIT_T, &of_t));
    CHECK(memcmp(of_t, t, COUNT * sizeof *t) == 0);
    clarity_kept_free(late);
    clarity_kept_free(none);
    clarity_kept_free(NULL);
    clarity_tracer_free(other);
    free(origins);
    free(t);
    free(uv);
    free(prim);
    free(instance);
}

/* Arrays of kept hits stay, and have the new hits, when instances were moved meanwhile: each hit has an instance then. */
void test_kept_moved(const clarity_scene* scene) {
    enum { COUNT = 40 };
    const clarity_options options = options_of("bvh2", NULL);
    clarity_tracer* tracer = NULL;
    clarity_kept* kept = NULL;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    WORKS(clarity_kept_new(tracer, 0, &kept));
    float origins[3 * COUNT], t[COUNT], uv[2 * COUNT];
    const float direction[] = {0, 0, -1}, lifted[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.5f};
    int32_t prim[COUNT], instance[COUNT];
    for (int i = 0; i < COUNT; ++i) {
        origins[3 * i] = 1.5f * (float)i / COUNT;
        origins[3 * i + 1] = 0.25f;
        origins[3 * i + 2] = 4;
    }
    clarity_rays query = one_ray(origins, direction);
    query.count = COUNT;
    query.origin_steps[0] = 3 * sizeof(float);
    const clarity_hits hits = hits_into(t, prim, instance, uv);
    void *arrays[4] = {0}, *again = NULL;
    WORKS(clarity_keep(tracer, &query, kept, NULL));
    for (int32_t which = 0; which < 4; ++which) WORKS(clarity_kept_array(kept, which, &arrays[which]));
    CHECK(((const float*)arrays[CLARITY_HIT_T])[0] == 4 && ((const int32_t*)arrays[CLARITY_HIT_INSTANCE])[0] == -1);
    clarity_places places = {0};
    places.struct_bytes = sizeof places;
    places.transforms = lifted;
    places.instance_count = 1;
    WORKS(clarity_move(tracer, &places, NULL));
    WORKS(clarity_keep(tracer, &query, kept, NULL));
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t[0] == 3.5f && instance[0] == 0 && instance[COUNT - 1] == -1);
    CHECK(memcmp(arrays[CLARITY_HIT_T], t, sizeof t) == 0 && memcmp(arrays[CLARITY_HIT_PRIM], prim, sizeof prim) == 0);
    CHECK(memcmp(arrays[CLARITY_HIT_UV], uv, sizeof uv) == 0);
    CHECK(memcmp(arrays[CLARITY_HIT_INSTANCE], instance, sizeof instance) == 0);
    for (int32_t which = 0; which < 4; ++which) {
        WORKS(clarity_kept_array(kept, which, &again));
        CHECK(again == arrays[which]);
    }
    clarity_kept_free(kept);
    clarity_tracer_free(tracer);
}

/* Rays that lie on the device. */
void test_packed(const clarity_scene* scene) {
    const clarity_options options = options_of("bvh2", NULL);
    clarity_tracer *tracer = NULL, *other = NULL;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    WORKS(clarity_tracer_new(scene, &options, NULL, &other));
    float origins[] = {0.75f, 0.25f, 4, 3, 3, 4}, t[2], direction[] = {0, 0, -2};
    clarity_rays arrays = {0}, query = {0};
    arrays.struct_bytes = query.struct_bytes = sizeof query;
    arrays.count = query.count = 2;
    arrays.origins = origins;
    arrays.directions = direction;
    arrays.origin_steps[0] = 3 * sizeof(float);
    arrays.origin_steps[1] = arrays.direction_steps[1] = sizeof(float);
    clarity_packed* packed = NULL;
    FAILS(clarity_pack(tracer, &arrays, NULL, NULL), CLARITY_USAGE, "`packed` is null");
    WORKS(clarity_pack(tracer, &arrays, NULL, &packed));
    memset(origins, 0, sizeof origins); /* they were read */
    query.packed = packed;
    const clarity_hits hits = hits_into(t, NULL, NULL, NULL);
    uint8_t occluded[2] = {9, 9};
    WORKS(clarity_closest(tracer, &query, &hits, NULL));
    CHECK(t[0] == 2 && isinf(t[1]));
    WORKS(clarity_any(tracer, &query, occluded, NULL));
    CHECK(occluded[0] == 1 && occluded[1] == 0);
    FAILS(clarity_closest(other, &query, &hits, NULL), CLARITY_USAGE, "another tracer");
    query.count = 3;
    FAILS(clarity_closest(tracer, &query, &hits, NULL), CLARITY_USAGE, "count is 3, and the packed rays are 2");
    int64_t counts[2];
    query.count = 2;
    FAILS(clarity_count(tracer, &query, counts, NULL), CLARITY_USAGE, "give the arrays");
    clarity_tracer_free(tracer); /* before its rays */
    clarity_packed_free(packed);
    clarity_packed_free(NULL);
    clarity_tracer_free(other);
}

/* All hits of two rays, as counts and as lists, and with a struct of the first release. */
void test_all_hits(const clarity_scene* scene) {
    const clarity_options options = options_of("bvh2", NULL);
    clarity_tracer* tracer = NULL;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    /* On the common edge of both triangles, past them, and in one of them. */
    const float origins[] = {0.5f, 0.5f, 4, 3, 3, 4, 0.75f, 0.25f, 4}, direction[] = {0, 0, -2};
    clarity_rays query = {0};
    query.struct_bytes = sizeof query;
    query.count = 3;
    query.origins = origins;
    query.directions = direction;
    query.origin_steps[0] = 3 * sizeof(float);
    query.origin_steps[1] = query.direction_steps[1] = sizeof(float);
    int64_t counts[3] = {9, 9, 9};
    WORKS(clarity_count(tracer, &query, counts, NULL));
    CHECK(counts[0] == 2 && counts[1] == 0 && counts[2] == 1);
    clarity_all_hits hits = {0};
    FAILS(clarity_all(tracer, &query, &hits, NULL), CLARITY_USAGE, "clarity_all_hits::struct_bytes is 0");
    hits.struct_bytes = sizeof hits;
    WORKS(clarity_all(tracer, &query, &hits, NULL));
    CHECK(hits.count == 3 && hits.first[0] == 0 && hits.first[1] == 2 && hits.first[2] == 2 && hits.first[3] == 3);
    CHECK(hits.ray[1] == 0 && hits.ray[2] == 2 && hits.t[0] == 2 && hits.t[2] == 2 && hits.instance[0] == -1);
    CHECK(hits.prim[0] == 0 && hits.prim[1] == 1 && hits.prim[2] == 0 && fabsf(hits.uv[4] - 0.5f) < 1e-6f);
    clarity_all_hits_free(&hits);
    CHECK(hits.count == 0 && !hits.t && !hits.owner && hits.struct_bytes == sizeof hits);
    clarity_all_hits_free(&hits);
    clarity_all_hits_free(NULL);

    query.mask = 256;
    FAILS(clarity_count(tracer, &query, counts, NULL), CLARITY_USAGE, "mask 256");
    query.struct_bytes = offsetof(clarity_rays, mask); /* what lies behind is not read */
    WORKS(clarity_count(tracer, &query, counts, NULL));
    query.struct_bytes -= 1;
    FAILS(clarity_count(tracer, &query, counts, NULL), CLARITY_USAGE, "clarity_rays::struct_bytes");
    query.struct_bytes = sizeof query;
    query.mask = 0;
    FAILS(clarity_count(tracer, &query, NULL, NULL), CLARITY_USAGE, "`counts` is null");
    FAILS(clarity_all(tracer, &query, NULL, NULL), CLARITY_USAGE, "clarity_all_hits is null");
    int32_t cancel = 1;
    clarity_watch watch = {0};
    watch.struct_bytes = sizeof watch;
    watch.cancel = &cancel;
    CHECK(clarity_all(tracer, &query, &hits, &watch) == CLARITY_CANCELLED && !hits.owner);
    clarity_tracer_free(tracer);
}

/* Three turns through these structures, whose programs stay in the process: more than 16 of them, which come back. */
void test_turns(const clarity_scene* scene) {
    const char* const accels[] = {"bvh2",    "grid", "linear", "brute", "bvh4",   "bvh8", "cwbvh",
                                  "spheres", "bsp",  "kdtree", "grid2", "octree", "lbvh", "ploc"};
    const size_t count = getenv("CLARITY_QUICK_TESTS") ? 1 : sizeof accels / sizeof accels[0];
    const float origins[] = {0.75f, 0.25f, 4, 3, 3, 4}, direction[] = {0, 0, -2};
    clarity_rays query = one_ray(origins, direction);
    query.count = 2;
    query.origin_steps[0] = 3 * sizeof(float);
    for (size_t i = 0; i < 3 * count; ++i) {
        const clarity_options options = options_of(accels[i % count], NULL);
        clarity_tracer* tracer = NULL;
        WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
        float t[2] = {0};
        int64_t counts[2] = {9, 9};
        uint8_t occluded[2] = {9, 9};
        const clarity_hits closest = hits_into(t, NULL, NULL, NULL);
        clarity_all_hits all = {0};
        all.struct_bytes = sizeof all;
        WORKS(clarity_closest(tracer, &query, &closest, NULL));
        WORKS(clarity_any(tracer, &query, occluded, NULL));
        WORKS(clarity_count(tracer, &query, counts, NULL));
        WORKS(clarity_all(tracer, &query, &all, NULL));
        const int right = t[0] == 2 && isinf(t[1]) && occluded[0] == 1 && occluded[1] == 0 && counts[0] == 1 &&
                          counts[1] == 0 && all.count == 1 && all.t[0] == 2;
        if (!right) fprintf(report, "%s, turn %d\n", accels[i % count], (int)(i / count));
        CHECK(right);
        clarity_all_hits_free(&all);
        clarity_tracer_free(tracer);
    }
}
