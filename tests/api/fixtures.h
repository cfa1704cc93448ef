/* fixtures.h -- a mesh and structs of calls, and the tests of query_tests.c. */
#ifndef FIXTURES_H
#define FIXTURES_H
#include "check.h"

/* A square in the plane z = 0, from 0 to 1. */
static const float square[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const uint32_t square_triangles[] = {0, 1, 2, 0, 2, 3};

static inline clarity_mesh mesh_of(int32_t type, const void* positions) {
    clarity_mesh mesh = {0};
    mesh.struct_bytes = sizeof mesh;
    mesh.type = type;
    mesh.vertex_count = 4;
    mesh.triangle_count = 2;
    mesh.positions = positions;
    mesh.triangles = square_triangles;
    return mesh;
}

static inline clarity_options options_of(const char* accel, const char* const* settings) {
    clarity_options options = {0};
    options.struct_bytes = sizeof options;
    options.accel = accel;
    options.settings = settings;
    return options;
}

static inline clarity_hits hits_into(float* t, int32_t* prim, int32_t* instance, float* uv) {
    clarity_hits hits = {0};
    hits.struct_bytes = sizeof hits;
    hits.t = t;
    hits.prim = prim;
    hits.instance = instance;
    hits.uv = uv;
    return hits;
}

static inline clarity_rays one_ray(const float origin[3], const float direction[3]) {
    clarity_rays rays = {0};
    rays.struct_bytes = sizeof rays;
    rays.count = 1;
    rays.origins = origin;
    rays.directions = direction;
    rays.origin_steps[1] = rays.direction_steps[1] = sizeof(float);
    return rays;
}

void test_rays(const clarity_scene* scene, const char* accel, const char* lanes);
void test_far(void);
void test_move(const clarity_scene* scene);
void test_move_cancelled(const clarity_scene* scene);
void test_rows(void);
void test_packed(const clarity_scene* scene);
void test_kept(const clarity_scene* scene, const char* lanes);
void test_kept_moved(const clarity_scene* scene);
void test_all_hits(const clarity_scene* scene);
void test_turns(const clarity_scene* scene);

#endif
