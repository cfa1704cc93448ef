/* An OpenCL driver as small as the loader accepts: one platform, which has no device (FAKE_EMPTY) or fails when it is asked for
 * them (FAKE_FAILING). */
#include <CL/cl.h>
#include <CL/cl_icd.h>
#include <string.h>

struct _cl_platform_id {
    const cl_icd_dispatch *dispatch; /* first, as the loader reads it */
};

static cl_int answer(const char *text, size_t bytes, void *value, size_t *needed)
{
    if (needed) *needed = strlen(text) + 1;
    if (value) {
        if (bytes < strlen(text) + 1) return CL_INVALID_VALUE;
        memcpy(value, text, strlen(text) + 1);
    }
    return CL_SUCCESS;
}

static cl_int CL_API_CALL platform_info(cl_platform_id platform, cl_platform_info what, size_t bytes, void *value, size_t *needed)
{
    (void)platform;
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

static cl_int CL_API_CALL device_ids(cl_platform_id platform, cl_device_type type, cl_uint entries, cl_device_id *devices,
                                     cl_uint *count)
{
    (void)platform, (void)type, (void)entries, (void)devices, (void)count;
#ifdef FAKE_FAILING
    return CL_OUT_OF_RESOURCES;
#else
    return CL_DEVICE_NOT_FOUND;
#endif
}

static cl_icd_dispatch dispatch;
static struct _cl_platform_id platform = {&dispatch};

CL_API_ENTRY cl_int CL_API_CALL clIcdGetPlatformIDsKHR(cl_uint entries, cl_platform_id *platforms, cl_uint *count)
{
    dispatch.clGetPlatformInfo = platform_info;
    dispatch.clGetDeviceIDs = device_ids;
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
