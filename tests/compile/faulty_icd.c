/* faulty_icd.c -- an OpenCL driver that forwards to PoCL and misbehaves on demand.
 *
 * All objects of a driver point to its table of functions. This driver loads PoCL, puts its own functions into PoCL's table, and
 * hands out PoCL's platform as its own. CLARITY_FAULT holds words with commas between them. So does the file that CLARITY_FAULT_FILE
 * names, if there is one, and it may change while the process runs:
 *   other              the platform has another name, so that it is treated as a driver that gives binaries cheaply
 *   build-hangs, build-crashes, build-exits, build-eats, build-refuses     what clBuildProgram does with a source
 *   build-hangs-late   the first build of a process is in order
 *   optimiser-crashes  clBuildProgram crashes, but with -cl-opt-disable it is in order
 *   method-crashes     clBuildProgram crashes, but with PoCL's work-group method cbs it is in order
 *   binary-flipped     binaries have a wrong byte; clBuildProgram refuses such ones with an error
 *   no-source          clCreateProgramWithSource fails: whoever comes here wanted to compile
 *   enqueue=CODE@N, buffer=CODE@N, read=CODE@N     the N-th launch, buffer, read-back and all after it fail with CODE
 *   launch-hangs       launches take for ever: the call does not return
 *   gpu                the device says that it is a GPU. Its launches are done when the call returns: PoCL compiles in the first
 *                      launch of a kernel, for longer than a launch may take on a machine that is busy, and no GPU does that
 *   launch-endless=N   the N-th launch and all after it return, but their events never complete, and neither does their queue;
 *                      the driver waits for them when the program ends
 *   read-short         read-backs leave the second half as it was
 * When something begins that takes for ever, the file that CLARITY_FAULT_MARK names is made. */
#define _GNU_SOURCE
#include <CL/cl.h>
#include <CL/cl_icd.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#pragma GCC visibility push(default)
cl_int CL_API_CALL clIcdGetPlatformIDsKHR(cl_uint count, cl_platform_id *platforms, cl_uint *found);
void *CL_API_CALL clGetExtensionFunctionAddress(const char *name);
#pragma GCC visibility pop

struct _cl_platform_id {
    cl_icd_dispatch *dispatch;
};

static cl_icd_dispatch real; /* PoCL's table as it was */
static const unsigned char wrong_magic = 0xEE;

/* Whether a list has the word; `value` gets what follows a '='. */
static int listed(const char *at, const char *word, const char **value)
{
    const size_t length = strlen(word);
    for (; at && *at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        if (strncmp(at, word, length) != 0) continue;
        if (at[length] == '=' && value) *value = at + length + 1;
        if (at[length] == '=' || at[length] == ',' || at[length] == 0) return 1;
    }
    return 0;
}

static int fault(const char *word, const char **value)
{
    static _Thread_local char text[256];
    if (listed(getenv("CLARITY_FAULT"), word, value)) return 1;
    const char *path = getenv("CLARITY_FAULT_FILE");
    FILE *file = path ? fopen(path, "r") : NULL;
    if (!file) return 0;
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    return listed(text, word, value);
}

/* The error of "word=CODE@N" from the N-th call on; calls are counted in *calls. */
static cl_int counted(const char *word, int *calls)
{
    const char *value = NULL;
    int code = 0, from = 0;
    if (!fault(word, &value) || !value || sscanf(value, "%d@%d", &code, &from) != 2) return CL_SUCCESS;
    return ++*calls >= from ? code : CL_SUCCESS;
}

static void mark_begin(void)
{
    const char *path = getenv("CLARITY_FAULT_MARK");
    FILE *file = path ? fopen(path, "w") : NULL;
    if (file) fclose(file);
}

static void hang(void)
{
    mark_begin();
    for (;;) sleep(1000);
}

static int endless; /* how many launches run for ever */
static cl_command_queue stuck[64];

static int is_stuck(cl_command_queue queue)
{
    for (int i = 0; i < endless && i < 64; ++i)
        if (stuck[i] == queue) return 1;
    return 0;
}

__attribute__((destructor)) static void unload(void)
{
    if (endless) hang();
}

static cl_int CL_API_CALL platform_info(cl_platform_id id, cl_platform_info what, size_t bytes, void *value, size_t *needed)
{
    static const char name[] = "Faulty platform";
    if (what != CL_PLATFORM_NAME || !fault("other", NULL)) return real.clGetPlatformInfo(id, what, bytes, value, needed);
    if (needed) *needed = sizeof name;
    if (value && bytes < sizeof name) return CL_INVALID_VALUE;
    if (value) memcpy(value, name, sizeof name);
    return CL_SUCCESS;
}

static cl_int CL_API_CALL device_info(cl_device_id id, cl_device_info what, size_t bytes, void *value, size_t *needed)
{
    const cl_int error = real.clGetDeviceInfo(id, what, bytes, value, needed);
    if (what == CL_DEVICE_TYPE && value && error == CL_SUCCESS && fault("gpu", NULL)) *(cl_device_type *)value = CL_DEVICE_TYPE_GPU;
    return error;
}

static int is_source(cl_program program)
{
    size_t bytes = 0;
    return real.clGetProgramInfo(program, CL_PROGRAM_SOURCE, 0, NULL, &bytes) == CL_SUCCESS && bytes > 1;
}

static cl_int CL_API_CALL build(cl_program program, cl_uint count, const cl_device_id *devices, const char *options,
                                void(CL_CALLBACK *done)(cl_program, void *), void *data)
{
    static int builds;
    ++builds;
    if (is_source(program)) {
        if (fault("build-hangs", NULL) || (fault("build-hangs-late", NULL) && builds > 1)) hang();
        const char *method = getenv("POCL_WORK_GROUP_METHOD");
        if (fault("build-crashes", NULL) || (fault("optimiser-crashes", NULL) && !(options && strstr(options, "-cl-opt-disable"))) ||
            (fault("method-crashes", NULL) && !(method && strcmp(method, "cbs") == 0))) {
            fprintf(stderr, "Instruction does not dominate all uses!\n");
            abort();
        }
        if (fault("build-exits", NULL)) _exit(3);
        if (fault("build-refuses", NULL)) return CL_BUILD_PROGRAM_FAILURE;
        while (fault("build-eats", NULL)) {
            const size_t piece = (size_t)256 << 20;
            void *eaten = mmap(NULL, piece, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
            if (eaten == MAP_FAILED) abort();
            memset(eaten, 1, piece);
        }
    }
    return real.clBuildProgram(program, count, devices, options, done, data);
}

static cl_program CL_API_CALL with_source(cl_context context, cl_uint count, const char **texts, const size_t *lengths,
                                          cl_int *error)
{
    if (!fault("no-source", NULL)) return real.clCreateProgramWithSource(context, count, texts, lengths, error);
    if (error) *error = CL_COMPILER_NOT_AVAILABLE;
    return NULL;
}

static cl_program CL_API_CALL with_binary(cl_context context, cl_uint count, const cl_device_id *devices, const size_t *lengths,
                                          const unsigned char **binaries, cl_int *status, cl_int *error)
{
    if (lengths[0] > 0 && binaries[0][0] == wrong_magic) {
        if (error) *error = CL_INVALID_BINARY;
        return NULL;
    }
    return real.clCreateProgramWithBinary(context, count, devices, lengths, binaries, status, error);
}

static cl_int CL_API_CALL program_info(cl_program program, cl_program_info what, size_t bytes, void *value, size_t *needed)
{
    const cl_int error = real.clGetProgramInfo(program, what, bytes, value, needed);
    if (what == CL_PROGRAM_BINARIES && value && error == CL_SUCCESS && fault("binary-flipped", NULL))
        (*(unsigned char **)value)[0] = wrong_magic;
    return error;
}

static cl_int CL_API_CALL launch(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *offset,
                                 const size_t *global, const size_t *local, cl_uint count, const cl_event *wait, cl_event *event)
{
    static int calls;
    const cl_int error = counted("enqueue", &calls);
    if (fault("launch-hangs", NULL)) hang();
    const char *from = NULL;
    static int launches;
    if (fault("launch-endless", &from) && ++launches >= (from ? atoi(from) : 1)) {
        stuck[endless++ % 64] = queue;
        cl_context context = NULL;
        cl_int made = real.clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, NULL);
        if (made) return made;
        mark_begin();
        const cl_event never = real.clCreateUserEvent(context, &made);
        return made ? made : real.clEnqueueMarkerWithWaitList(queue, 1, &never, event);
    }
    if (error) return error;
    const cl_int launched = real.clEnqueueNDRangeKernel(queue, kernel, dimensions, offset, global, local, count, wait, event);
    if (launched == CL_SUCCESS && fault("gpu", NULL) && !is_stuck(queue)) real.clFinish(queue);
    return launched;
}

static cl_mem CL_API_CALL buffer(cl_context context, cl_mem_flags flags, size_t bytes, void *host, cl_int *error)
{
    static int calls;
    const cl_int code = counted("buffer", &calls);
    if (!code) return real.clCreateBuffer(context, flags, bytes, host, error);
    if (error) *error = code;
    return NULL;
}

static cl_int CL_API_CALL read_back(cl_command_queue queue, cl_mem from, cl_bool blocking, size_t offset, size_t bytes, void *to,
                                    cl_uint count, const cl_event *wait, cl_event *event)
{
    static int calls;
    const cl_int error = counted("read", &calls);
    if (error) return error;
    if (fault("read-short", NULL)) bytes = (bytes + 1) / 2;
    return real.clEnqueueReadBuffer(queue, from, blocking, offset, bytes, to, count, wait, event);
}

static cl_platform_id load(void)
{
    static cl_platform_id platform;
    static int tried;
    if (tried++) return platform;
    void *library = dlopen("libpocl.so.2", RTLD_NOW | RTLD_LOCAL);
    if (!library) return NULL;
    void *(*address)(const char *) = (void *(*)(const char *))dlsym(library, "clGetExtensionFunctionAddress");
    if (!address) return NULL;
    cl_int (*platforms)(cl_uint, cl_platform_id *, cl_uint *) =
        (cl_int(*)(cl_uint, cl_platform_id *, cl_uint *))address("clIcdGetPlatformIDsKHR");
    if (!platforms || platforms(1, &platform, NULL) != CL_SUCCESS) return NULL;
    cl_icd_dispatch *table = platform->dispatch;
    real = *table;
    table->clGetPlatformInfo = platform_info;
    table->clGetDeviceInfo = device_info;
    table->clBuildProgram = build;
    table->clCreateProgramWithSource = with_source;
    table->clCreateProgramWithBinary = with_binary;
    table->clGetProgramInfo = program_info;
    table->clEnqueueNDRangeKernel = launch;
    table->clCreateBuffer = buffer;
    table->clEnqueueReadBuffer = read_back;
    return platform;
}

cl_int CL_API_CALL clIcdGetPlatformIDsKHR(cl_uint count, cl_platform_id *platforms, cl_uint *found)
{
    const cl_platform_id platform = load();
    if (found) *found = platform ? 1 : 0;
    if (!platform) return CL_PLATFORM_NOT_FOUND_KHR;
    if (platforms && count > 0) platforms[0] = platform;
    return CL_SUCCESS;
}

void *CL_API_CALL clGetExtensionFunctionAddress(const char *name)
{
    if (strcmp(name, "clIcdGetPlatformIDsKHR") == 0) return (void *)(size_t)clIcdGetPlatformIDsKHR;
    const cl_platform_id platform = load();
    if (strcmp(name, "clGetPlatformInfo") == 0) return (void *)(size_t)platform_info;
    return platform ? real.clGetExtensionFunctionAddress(name) : NULL;
}
