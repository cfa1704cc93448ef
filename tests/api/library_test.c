/* library_test.c -- all calls of libclarity.so from C99: right ones, wrong ones, cancelled ones, from two threads and after a fork.
 *   library_test FOLDER    FOLDER: for files of the test */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fixtures.h"

FILE* report;
int failures;

static const char* folder;
static char scene_file[4096];
static int32_t log_lines, refused_folder;

static void on_log(void* user, int32_t level, const char* text) {
    (void)user;
    ++log_lines;
    if (level == CLARITY_LOG_WARNING && strstr(text, "no_such_folder")) refused_folder = 1;
}

static void test_scenes(void) {
    const clarity_mesh mesh = mesh_of(CLARITY_FLOAT32, square);
    clarity_scene* const none = NULL;
    clarity_scene* scene = none;
    FAILS(clarity_scene_from_mesh(NULL, NULL, &scene), CLARITY_USAGE, "clarity_mesh is null");
    FAILS(clarity_scene_from_mesh(&mesh, NULL, NULL), CLARITY_USAGE, "`scene` is null");
    clarity_mesh bad = mesh;
    bad.struct_bytes = 8;
    FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, "clarity_mesh::struct_bytes is 8");
    bad = mesh;
    bad.type = 7;
    FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, "unknown type 7");
    bad = mesh;
    bad.vertex_count = 3;
    FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, "vertex 3");
    bad = mesh;
    bad.positions = NULL;
    FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, "null pointer");
    bad = mesh;
    bad.triangle_count = UINT64_MAX / 3;
    FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, "2^31");
    float not_finite[12];
    memcpy(not_finite, square, sizeof square);
    not_finite[4] = NAN;
    bad = mesh_of(CLARITY_FLOAT32, not_finite);
    FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, "mesh of arrays");
    FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, "not finite: of vertex 1");
    const double lengths[] = {2e15, 2e-18};
    const char* const words[] = {"beyond 1e15", "less than 1e-17"};
    for (int i = 0; i < 2; ++i) {
        double positions[12];
        float floats[12];
        for (int k = 0; k < 12; ++k) floats[k] = (float)(positions[k] = square[k] * lengths[i]);
        bad = mesh_of(CLARITY_FLOAT64, positions);
        FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, words[i]);
        bad = mesh_of(CLARITY_FLOAT32, floats);
        FAILS(clarity_scene_from_mesh(&bad, NULL, &scene), CLARITY_USAGE, words[i]);
    }
    const char* const missing[] = {"/no/such/file.obj"};
    FAILS(clarity_scene_load(missing, 1, NULL, &scene), CLARITY_IMPORT_FAILED, missing[0]);
    FAILS(clarity_scene_load(missing, 0, NULL, &scene), CLARITY_USAGE, "no scene file");
    FAILS(clarity_scene_load(NULL, 1, NULL, &scene), CLARITY_USAGE, "`files` is null");
    CHECK(scene == none);

    snprintf(scene_file, sizeof scene_file, "%s/two.scene", folder);
    FILE* const file = fopen(scene_file, "w");
    CHECK(file && fputs("sphere center 0 0 0 radius 1\nsphere center 0 0 -5 radius 1\n", file) >= 0 && fclose(file) == 0);
    const char* const files[] = {scene_file};
    const char* json = NULL;
    double lo[3], hi[3];
    WORKS(clarity_scene_load(files, 1, NULL, &scene));
    WORKS(clarity_scene_info(scene, &json));
    CHECK(json && strstr(json, "\"spheres\": 2") && strstr(json, scene_file));
    WORKS(clarity_scene_bounds(scene, lo, hi));
    CHECK(lo[2] == -6 && hi[2] == 1);
    FAILS(clarity_scene_info(NULL, &json), CLARITY_USAGE, "`scene` is null");
    FAILS(clarity_scene_bounds(scene, lo, NULL), CLARITY_USAGE, "`hi` is null");
    clarity_scene_free(scene);
    clarity_scene_free(NULL);
    clarity_tracer_free(NULL);
}

static void test_options(const clarity_scene* scene) {
    clarity_tracer* tracer = NULL;
    clarity_options options = options_of("no_such_tree", NULL);
    FAILS(clarity_tracer_new(scene, &options, NULL, &tracer), CLARITY_USAGE, "no_such_tree");
    options = options_of("bvh2,max_leaf=-3", NULL);
    FAILS(clarity_tracer_new(scene, &options, NULL, &tracer), CLARITY_USAGE, "max_leaf");
    const char* unknown[] = {"no_such_setting=1", NULL};
    options = options_of("bvh2", unknown);
    FAILS(clarity_tracer_new(scene, &options, NULL, &tracer), CLARITY_USAGE, "no_such_setting");
    unknown[0] = "word";
    FAILS(clarity_tracer_new(scene, &options, NULL, &tracer), CLARITY_USAGE, "key=value");
    unknown[0] = "light.0=off";
    FAILS(clarity_tracer_new(scene, &options, NULL, &tracer), CLARITY_USAGE, "clarity_render");
    options = options_of("bvh2", NULL);
    options.device = "no such device";
    FAILS(clarity_tracer_new(scene, &options, NULL, &tracer), CLARITY_NO_DEVICE, "no such device");
    options.struct_bytes = 0;
    FAILS(clarity_tracer_new(scene, &options, NULL, &tracer), CLARITY_USAGE, "sizeof(clarity_options)");
    FAILS(clarity_tracer_new(NULL, NULL, NULL, &tracer), CLARITY_USAGE, "`scene` is null");
    CHECK(tracer == NULL);
}

static void test_pictures(const clarity_scene* scene) {
    const clarity_options options = options_of("bvh2", NULL);
    clarity_tracer* tracer = NULL;
    WORKS(clarity_tracer_new(scene, &options, NULL, &tracer));
    const char* settings[] = {"size=6x4", "aov=t", NULL};
    float pixels[6 * 4 * 3 + 1];
    for (size_t i = 0; i < sizeof pixels / sizeof *pixels; ++i) pixels[i] = -7;
    clarity_picture picture = {0};
    picture.struct_bytes = sizeof picture;
    picture.settings = settings;
    picture.camera = "0.5,0.5,3,0.5,0.5,0,20";
    WORKS(clarity_render(tracer, &picture, NULL));
    CHECK(picture.channels == 1 && picture.width == 6 && picture.height == 4);
    picture.pixels = pixels;
    picture.room = 23;
    FAILS(clarity_render(tracer, &picture, NULL), CLARITY_USAGE, "24 floats");
    CHECK(pixels[0] == -7);
    picture.room = 24;
    WORKS(clarity_render(tracer, &picture, NULL));
    CHECK(fabsf(pixels[9] - 3) < 0.1f && isinf(pixels[0]) && pixels[24] == -7);
    settings[1] = "spp=3";
    picture.room = 72;
    WORKS(clarity_render(tracer, &picture, NULL));
    CHECK(picture.channels == 3 && pixels[71] >= 0 && pixels[72] == -7);
    picture.camera = "no such camera";
    FAILS(clarity_render(tracer, &picture, NULL), CLARITY_USAGE, "no such camera");
    picture.camera = NULL;
    settings[1] = "hide=0";
    FAILS(clarity_render(tracer, &picture, NULL), CLARITY_USAGE, "stay where they are");
    settings[1] = "material.0.color=1,0,0";
    WORKS(clarity_render(tracer, &picture, NULL));
    FAILS(clarity_render(tracer, NULL, NULL), CLARITY_USAGE, "clarity_picture is null");
    clarity_tracer_free(tracer);
}

static clarity_tracer* asked_in_callback;
static int32_t asks_library(void* user, const char* stage, float fraction) {
    (void)user, (void)stage, (void)fraction;
    const char* json = NULL;
    FAILS(clarity_tracer_info(asked_in_callback, &json), CLARITY_USAGE, "called by a function that it calls itself");
    return 1;
}

static void test_digest(void) {
    static unsigned char bytes[3000000];
    char first[33], second[33];
    for (size_t i = 0; i < sizeof bytes; ++i) bytes[i] = (unsigned char)(i * 7 / 3);
    WORKS(clarity_digest(bytes, sizeof bytes, first));
    WORKS(clarity_digest(bytes, sizeof bytes, second));
    CHECK(strlen(first) == 32 && strcmp(first, second) == 0);
    const size_t places[] = {0, 1048576, sizeof bytes - 1};
    for (int i = 0; i < 3; ++i) {
        bytes[places[i]] ^= 1;
        WORKS(clarity_digest(bytes, sizeof bytes, second));
        CHECK(strcmp(first, second) != 0);
        bytes[places[i]] ^= 1;
    }
    WORKS(clarity_digest(bytes, sizeof bytes - 1, second));
    CHECK(strcmp(first, second) != 0);
    WORKS(clarity_digest(NULL, 0, second));
    FAILS(clarity_digest(NULL, 1, second), CLARITY_USAGE, "`bytes` is null");
    FAILS(clarity_digest(bytes, 1, NULL), CLARITY_USAGE, "`digest` is null");
}

struct told {
    int calls, go_on;
    char stages[4096];
};
static int32_t on_progress(void* user, const char* stage, float fraction) {
    struct told* const told = user;
    ++told->calls;
    CHECK(fraction <= 1);
    if (!strstr(told->stages, stage)) strncat(told->stages, stage, sizeof told->stages - strlen(told->stages) - 1);
    return told->go_on;
}

static void test_watch(const clarity_scene* scene) {
    struct told told = {0, 1, ""};
    int32_t cancel = 0;
    clarity_watch watch = {0};
    watch.struct_bytes = sizeof watch;
    watch.progress = on_progress;
    watch.user = &told;
    watch.cancel = &cancel;
    const clarity_options options = options_of("bvh4", NULL);
    clarity_tracer* tracer = NULL;
    WORKS(clarity_tracer_new(scene, &options, &watch, &tracer));
    CHECK(strstr(told.stages, "building bvh4") && strstr(told.stages, "uploading"));
    clarity_tracer* second = NULL;
    told.go_on = 0;
    CHECK(clarity_tracer_new(scene, &options, &watch, &second) == CLARITY_CANCELLED && second == NULL);
    const float origin[] = {0, 0, 1}, direction[] = {0, 0, -1};
    float t = -7;
    const clarity_hits hits = hits_into(&t, NULL, NULL, NULL);
    clarity_rays query = one_ray(origin, direction);
    told.go_on = 1;
    cancel = 1;
    CHECK(clarity_closest(tracer, &query, &hits, &watch) == CLARITY_CANCELLED && t == -7);
    const char* const files[] = {scene_file};
    clarity_scene* imported = NULL;
    CHECK(clarity_scene_load(files, 1, &watch, &imported) == CLARITY_CANCELLED && imported == NULL);
    cancel = 0;
    WORKS(clarity_closest(tracer, &query, &hits, &watch));
    CHECK(t == 1);
    asked_in_callback = tracer;
    watch.progress = asks_library;
    WORKS(clarity_closest(tracer, &query, &hits, &watch));
    watch.struct_bytes = 3;
    FAILS(clarity_closest(tracer, &query, &hits, &watch), CLARITY_USAGE, "clarity_watch::struct_bytes");
    clarity_tracer_free(tracer);
}

enum { kRays = 20000 };
/* Traces rays by a scene and a tracer of its own; every fourth ray hits. */
static void* trace_alone(void* accel) {
    const clarity_mesh mesh = mesh_of(CLARITY_FLOAT32, square);
    const clarity_options options = options_of(accel, NULL);
    clarity_scene* scene = NULL;
    clarity_tracer* tracer = NULL;
    float *const origins = malloc(kRays * 3 * sizeof(float)), *const t = malloc(kRays * sizeof(float)), direction[] = {0, 0, -1};
    for (int i = 0; i < kRays; ++i) {
        origins[3 * i] = 0.5f + (float)(i % 4);
        origins[3 * i + 1] = 0.25f;
        origins[3 * i + 2] = 1 + (float)(i % 7);
    }
    clarity_rays query = {0};
    query.struct_bytes = sizeof query;
    query.count = kRays;
    query.origins = origins;
    query.directions = direction;
    query.origin_steps[0] = 3 * sizeof(float);
    query.origin_steps[1] = query.direction_steps[1] = sizeof(float);
    const clarity_hits hits = hits_into(t, NULL, NULL, NULL);
    long wrong = 0;
    if (clarity_scene_from_mesh(&mesh, NULL, &scene) || clarity_tracer_new(scene, &options, NULL, &tracer)) wrong = -1;
    for (int round = 0; round < 5 && wrong == 0; ++round) {
        if (clarity_closest(tracer, &query, &hits, NULL)) wrong = -2;
        for (int i = 0; i < kRays && wrong >= 0; ++i) wrong += t[i] != (i % 4 ? INFINITY : 1 + (float)(i % 7));
        /* An error of this thread is no error of the other one. */
        if (clarity_closest(tracer, NULL, &hits, NULL) != CLARITY_USAGE || !clarity_error_text()[0]) wrong = -3;
    }
    clarity_tracer_free(tracer);
    clarity_scene_free(scene);
    free(origins);
    free(t);
    return (void*)wrong;
}

static void test_threads(void) {
    pthread_t threads[2];
    char* const accels[] = {"bvh2", "grid"};
    const int32_t code = clarity_scene_info(NULL, NULL);
    for (int i = 0; i < 2; ++i) CHECK(pthread_create(&threads[i], NULL, trace_alone, accels[i]) == 0);
    for (int i = 0; i < 2; ++i) {
        void* wrong = NULL;
        CHECK(pthread_join(threads[i], &wrong) == 0);
        if (wrong) fprintf(report, "%s: %ld hits are wrong (negative: a call)\n", accels[i], (long)wrong);
        CHECK(wrong == NULL);
    }
    CHECK(code == CLARITY_USAGE && strstr(clarity_error_text(), "`scene` is null"));
}

static void* ask_info(void* of) {
    const float origin[] = {0.75f, 0.25f, 1}, direction[] = {0, 0, -1};
    float t = 0;
    const char* json = NULL;
    const clarity_hits hits = hits_into(&t, NULL, NULL, NULL);
    const clarity_rays query = one_ray(origin, direction);
    WORKS(clarity_closest(of, &query, &hits, NULL)); /* so its text is another one */
    for (int i = 0; i < 100; ++i) WORKS(clarity_tracer_info(of, &json));
    return NULL;
}

/* What a thread was told about a tracer stays while another thread asks, too. */
static void test_info(clarity_tracer* tracer) {
    const char* json = NULL;
    char copy[4096];
    pthread_t other;
    WORKS(clarity_tracer_info(tracer, &json));
    CHECK(strlen(json) < sizeof copy);
    snprintf(copy, sizeof copy, "%s", json);
    CHECK(pthread_create(&other, NULL, ask_info, tracer) == 0 && pthread_join(other, NULL) == 0);
    CHECK(strcmp(json, copy) == 0);
}

static void test_fork(clarity_scene* scene, clarity_tracer* tracer) {
    const pid_t child = fork();
    if (child == 0) {
        const char* json = NULL;
        int bad = clarity_scene_info(scene, &json) != CLARITY_FORKED || !strstr(clarity_error_text(), "forked");
        bad |= clarity_tracer_new(scene, NULL, NULL, &tracer) != CLARITY_FORKED;
        clarity_tracer_free(tracer);
        clarity_scene_free(scene);
        _exit(bad);
    }
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* Traces for ever, until the library ends. Returns how it ended. */
static void* trace_on(void* user) {
    int32_t* const rounds = user;
    const clarity_mesh mesh = mesh_of(CLARITY_FLOAT32, square);
    const clarity_options options = options_of("bvh2", NULL);
    clarity_scene* scene = NULL;
    clarity_tracer* tracer = NULL;
    const float origin[] = {0.5f, 0.25f, 1}, direction[] = {0, 0, -1};
    const clarity_rays query = one_ray(origin, direction);
    float t = 0;
    const clarity_hits hits = hits_into(&t, NULL, NULL, NULL);
    intptr_t code = clarity_scene_from_mesh(&mesh, NULL, &scene);
    if (!code) code = clarity_tracer_new(scene, &options, NULL, &tracer);
    while (!code) {
        code = clarity_closest(tracer, &query, &hits, NULL);
        __atomic_add_fetch(rounds, 1, __ATOMIC_RELAXED);
    }
    clarity_tracer_free(tracer); /* stays */
    return (void*)code;
}

static void test_end(clarity_tracer* tracer) {
    pthread_t thread;
    int32_t rounds = 0;
    CHECK(pthread_create(&thread, NULL, trace_on, &rounds) == 0);
    while (__atomic_load_n(&rounds, __ATOMIC_RELAXED) < 3) sched_yield();
    WORKS(clarity_end());
    void* code = NULL;
    CHECK(pthread_join(thread, &code) == 0 && (intptr_t)code == CLARITY_ENDED);
    const float origin[] = {0.5f, 0.25f, 1}, direction[] = {0, 0, -1};
    const clarity_rays query = one_ray(origin, direction);
    float t = 0;
    const clarity_hits hits = hits_into(&t, NULL, NULL, NULL);
    WORKS(clarity_closest(tracer, &query, &hits, NULL)); /* this thread goes on */
    CHECK(t == 1);
}

/* Calls that are no use of the library leave a child free to use it. */
static void test_fork_before_use(void) {
    const pid_t child = fork();
    if (child == 0) {
        const clarity_mesh mesh = mesh_of(CLARITY_FLOAT32, square);
        clarity_scene* scene = NULL;
        _exit(clarity_scene_from_mesh(&mesh, NULL, &scene));
    }
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

int main(int argc, char** argv) {
    folder = argc > 1 ? argv[1] : ".";
    mkdir(folder, 0777);
    report = fdopen(dup(2), "w");
    setvbuf(report, NULL, _IONBF, 0);
    char path[4096];
    snprintf(path, sizeof path, "%s/printed.txt", folder);
    if (!freopen(path, "w", stdout) || dup2(fileno(stdout), 2) < 0) return 1;

    CHECK(strlen(clarity_header_digest()) == 64 && clarity_version()[0]);
    setenv("CLARITY_PLUGIN_PATH", "/no_such_folder", 1); /* of which a warning tells */
    WORKS(clarity_set_log(on_log, NULL));
    FAILS(clarity_set_program("/no/such/program"), CLARITY_USAGE, "/no/such/program");
    test_fork_before_use();
    test_digest();
    test_scenes();
    CHECK(refused_folder == 1);
    FAILS(clarity_set_program("/bin/true"), CLARITY_USAGE, "call it first");

    const clarity_mesh mesh = mesh_of(CLARITY_FLOAT32, square);
    clarity_scene* scene = NULL;
    clarity_tracer* tracer = NULL;
    WORKS(clarity_scene_from_mesh(&mesh, NULL, &scene));
    const int32_t code = clarity_tracer_new(scene, NULL, NULL, &tracer);
    if (code == CLARITY_NO_DEVICE && failures == 0) {
        fprintf(report, "skipped: %s\n", clarity_error_text());
        return 77;
    }
    CHECK(code == CLARITY_OK);
    test_options(scene);
    test_rays(scene, "bvh2", "lanes=1");
    test_rays(scene, "grid", "lanes=8");
    test_all_hits(scene);
    test_turns(scene);
    test_kept(scene, "lanes=1");
    test_kept(scene, "lanes=16");
    test_kept_moved(scene);
    test_packed(scene);
    test_move(scene);
    test_move_cancelled(scene);
    test_rows();
    test_far();
    test_pictures(scene);
    test_watch(scene);
    test_threads();
    test_info(tracer);
    test_fork(scene, tracer);
    test_end(tracer);
    clarity_tracer_free(tracer);
    clarity_scene_free(scene);
    WORKS(clarity_set_log(NULL, NULL));

    fflush(stdout);
    struct stat printed;
    CHECK(stat(path, &printed) == 0 && printed.st_size == 0); /* else see the file */
    fprintf(report, "%d failures, %d lines of the log\n", failures, (int)log_lines);
    return failures ? 1 : 0;
}
