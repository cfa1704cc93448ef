/* fake_icd.c -- the smallest OpenCL driver which the loader accepts. It has one platform without devices (FAKE_EMPTY), which
 * fails to list its devices (FAKE_FAILING), or with a device which cannot be opened (FAKE_BROKEN). */
#include <CL/cl.h>
#include <CL/cl_icd.h>
#include <string.h>

struct _cl_platform_id {
    const cl_icd_dispatch *dispatch; /* the loader expects it as the first member */
};

static cl_icd_dispatch dispatch;
static struct _cl_platform_id platform = {&dispatch};

static cl_int answer(const char *text, size_t bytes, void *value, size_t *needed)
{
    if (needed) *needed = strlen(text) + 1;
    if (value) {
        if (bytes < strlen(text) + 1) return CL_INVALID_VALUE;
        memcpy(value, text, strlen(text) + 1);
    }
    return CL_SUCCESS;
}

static cl_int CL_API_CALL platform_info(cl_platform_id id, cl_platform_info what, size_t bytes, void *value, size_t *needed)
{
    (void)id;
    switch (what) {
    case CL_PLATFORM_NAME: return answer("Fake platform", bytes, value, needed);
    case CL_PLATFORM_VENDOR: return answer("Fake vendor", bytes, value, needed);
    case CL_PLATFORM_VERSION: return answer("OpenCL 1.2 fake", bytes, value, needed);
    case CL_PLATFORM_PROFILE: return answer("FULL_PROFILE", bytes, value, needed);
    case CL_PLATFORM_EXTENSIONS: return answer("cl_khr_icd", bytes, value, needed);
    case CL_PLATFORM_ICD_SUFFIX_KHR: return answer("FAKE", bytes, value, needed);
    default: return CL_INVALID_VALUE;
    }
}

#ifdef FAKE_BROKEN
struct _cl_device_id {
    const cl_icd_dispatch *dispatch;
};
static struct _cl_device_id device;

static cl_int number(cl_ulong value, size_t bytes, void *to, size_t room, size_t *needed)
{
    if (needed) *needed = bytes;
    if (to && room < bytes) return CL_INVALID_VALUE;
    if (to) memcpy(to, &value, bytes); /* assumes little-endian, as all machines with OpenCL are */
    return CL_SUCCESS;
}

static cl_int CL_API_CALL device_info(cl_device_id id, cl_device_info what, size_t bytes, void *value, size_t *needed)
{
    (void)id;
    switch (what) {
    case CL_DEVICE_NAME: return answer("Broken device", bytes, value, needed);
    case CL_DEVICE_VENDOR: return answer("Fake vendor", bytes, value, needed);
    case CL_DEVICE_VERSION: return answer("OpenCL 1.2 fake", bytes, value, needed);
    case CL_DRIVER_VERSION: return answer("1", bytes, value, needed);
    case CL_DEVICE_PLATFORM: return number((cl_ulong)(size_t)&platform, sizeof(cl_platform_id), value, bytes, needed);
    case CL_DEVICE_TYPE: return number(CL_DEVICE_TYPE_ACCELERATOR, sizeof(cl_device_type), value, bytes, needed);
    case CL_DEVICE_GLOBAL_MEM_SIZE:
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE: return number(1u << 30, sizeof(cl_ulong), value, bytes, needed);
    default: return number(1, sizeof(cl_uint), value, bytes, needed);
    }
}

static cl_int CL_API_CALL keep_device(cl_device_id id)
{
    (void)id;
    return CL_SUCCESS;
}

static cl_context CL_API_CALL create_context(const cl_context_properties *properties, cl_uint count, const cl_device_id *devices,
                                             void(CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *user,
                                             cl_int *error)
{
    (void)properties, (void)count, (void)devices, (void)notify, (void)user;
    if (error) *error = CL_OUT_OF_RESOURCES;
    return NULL;
}
#endif

static cl_int CL_API_CALL device_ids(cl_platform_id id, cl_device_type type, cl_uint entries, cl_device_id *devices,
                                     cl_uint *count)
{
    (void)id, (void)type, (void)entries, (void)devices, (void)count;
#ifdef FAKE_FAILING
    return CL_OUT_OF_RESOURCES;
#elif defined(FAKE_BROKEN)
    if (count) *count = 1;
    if (devices && entries > 0) devices[0] = &device;
    return CL_SUCCESS;
#else
    return CL_DEVICE_NOT_FOUND;
#endif
}

CL_API_ENTRY cl_int CL_API_CALL clIcdGetPlatformIDsKHR(cl_uint entries, cl_platform_id *platforms, cl_uint *count)
{
    dispatch.clGetPlatformInfo = platform_info;
    dispatch.clGetDeviceIDs = device_ids;
#ifdef FAKE_BROKEN
    device.dispatch = &dispatch;
    dispatch.clGetDeviceInfo = device_info;
    dispatch.clRetainDevice = dispatch.clReleaseDevice = keep_device;
    dispatch.clCreateContext = create_context;
#endif
    if (count) *count = 1;
    if (platforms && entries > 0) platforms[0] = &platform;
    return CL_SUCCESS;
}

CL_API_ENTRY cl_int CL_API_CALL clGetPlatformInfo(cl_platform_id id, cl_platform_info what, size_t bytes, void *value, size_t *needed)
{
    return platform_info(id, what, bytes, value, needed);
}

CL_API_ENTRY void *CL_API_CALL clGetExtensionFunctionAddress(const char *name)
{
    if (strcmp(name, "clIcdGetPlatformIDsKHR") == 0) return (void *)clIcdGetPlatformIDsKHR;
    if (strcmp(name, "clGetPlatformInfo") == 0) return (void *)clGetPlatformInfo;
    return 0;
}
