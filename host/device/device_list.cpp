// device_list.cpp -- lists the OpenCL devices, best first.
//
// Some machines have platforms without devices (Mesa's rusticl without a GPU), drivers that fail, or no driver. Each of these
// causes one warning and never an error.
#include <sched.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <mutex>
#include <tuple>
#include <utility>

#include "base/log.hpp"
#include "base/problem.hpp"
#include "base/text.hpp"
#include "device/device_list.hpp"
#include "device/pocl_cache.hpp"

namespace clarity {

bool says(const std::string& text, const std::string& part) {
    return lower(text).find(lower(part)) != std::string::npos;
}

namespace {

constexpr const char* kPocl = "Portable Computing Language";

// Removes the blanks and zero bytes with which drivers pad names.
std::string trimmed(std::string text) {
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
    text.erase(0, std::min(text.find_first_not_of(' '), text.size()));
    return text;
}

std::string error_name(int code) {
    switch (code) {
        case CL_DEVICE_NOT_FOUND:
            return "it has no device";
        case CL_DEVICE_NOT_AVAILABLE:
            return "its device is not available";
        case CL_OUT_OF_HOST_MEMORY:
            return "it ran out of host memory";
        case CL_OUT_OF_RESOURCES:
            return "it ran out of resources";
        default:
            return "it answers with OpenCL error " + std::to_string(code);
    }
}

template <class Value>
Value ask(const cl::Device& device, cl_device_info what) {
    Value value{};
    const cl_int status = device.getInfo(what, &value);
    if (status != CL_SUCCESS) throw cl::Error(status, "clGetDeviceInfo");
    return value;
}

DeviceInfo describe(const cl::Platform& platform, const cl::Device& device, unsigned platform_index, unsigned device_index) {
    DeviceInfo info;
    info.platform_index = platform_index;
    info.device_index = device_index;
    info.cl_platform = platform;
    info.cl_device = device;
    info.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
    info.name = trimmed(ask<std::string>(device, CL_DEVICE_NAME));
    info.vendor = trimmed(ask<std::string>(device, CL_DEVICE_VENDOR));
    info.version = trimmed(ask<std::string>(device, CL_DEVICE_VERSION));
    info.driver = trimmed(ask<std::string>(device, CL_DRIVER_VERSION));
    const auto type = ask<cl_device_type>(device, CL_DEVICE_TYPE);
    info.cpu = type & CL_DEVICE_TYPE_CPU;
    info.gpu = type & CL_DEVICE_TYPE_GPU;
    info.compute_units = ask<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
    info.clock_mhz = ask<cl_uint>(device, CL_DEVICE_MAX_CLOCK_FREQUENCY);
    info.float_width = std::max(1u, ask<cl_uint>(device, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT));
    info.global_bytes = ask<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
    info.max_allocation_bytes = ask<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
    info.cache_bytes = ask<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_CACHE_SIZE);
    info.local_bytes = ask<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE);
    info.cache_line_bytes = ask<cl_uint>(device, CL_DEVICE_GLOBAL_MEM_CACHELINE_SIZE);
    info.pocl = says(info.platform, kPocl);
    info.nvidia = says(info.vendor, "NVIDIA");
    info.llvmpipe = info.platform == "rusticl" && says(info.name, "llvmpipe");
    return info;
}

// Returns why a device cannot be used; empty if it can.
Problem why_unusable(const cl::Device& device) {
    if (!ask<cl_bool>(device, CL_DEVICE_AVAILABLE)) return "its driver says that it is not available";
    if (!ask<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE)) return "its driver has no compiler";
    return {};
}

void list_platform(const cl::Platform& platform, unsigned index, std::vector<DeviceInfo>& found,
                   const std::function<void(const std::string&, bool is_minor)>& warn) {
    std::string name = "platform " + std::to_string(index);
    std::vector<cl::Device> devices;
    try {
        const std::vector<pid_t> before = thread_ids();
        const std::string title = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
        name += " (" + title + ")";
        platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
        if (says(title, kPocl)) {
            size_t units = 0;
            for (const cl::Device& device : devices) units += ask<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
            pin_threads_since(before, units);
        }
        if (devices.empty()) throw cl::Error(CL_DEVICE_NOT_FOUND, "clGetDeviceIDs");
    } catch (const cl::Error& e) {
        warn(name + " is skipped: " + error_name(e.err()), e.err() == CL_DEVICE_NOT_FOUND);
        return;
    }
    for (unsigned i = 0; i < devices.size(); ++i) {
        Problem why;
        try {
            why = why_unusable(devices[i]);
            if (!why) found.push_back(describe(platform, devices[i], index, i));
        } catch (const cl::Error& e) {
            why = error_name(e.err());
        }
        if (why)
            warn("device " + std::to_string(index) + ":" + std::to_string(i) + " of " + name + " is skipped: " + why.text(),
                 false);
    }
}

}  // namespace

std::vector<DeviceInfo> list_devices(std::vector<DeviceWarning>* warnings) {
    // PoCL 3.1 crashes, or tells of no device, if two threads of a process ask it first.
    static std::mutex one_at_a_time;
    const std::lock_guard<std::mutex> lock(one_at_a_time);
    static std::string cache_warning = prepare_pocl_cache();  // told once, and only if PoCL is there
    const auto warn = [&](const std::string& text, bool is_minor = false) {
        if (warnings) warnings->push_back({text, is_minor});
    };
    std::vector<DeviceInfo> found;
    std::vector<cl::Platform> platforms;
    try {
        cl::Platform::get(&platforms);
    } catch (const cl::Error& e) {
        // Without any driver, the loader returns CL_PLATFORM_NOT_FOUND_KHR. This is not a failure.
        constexpr int kPlatformNotFound = -1001;
        if (e.err() != kPlatformNotFound)
            warn("the OpenCL loader answers clGetPlatformIDs with error " + std::to_string(e.err()));
    }
    if (platforms.empty()) warn(std::string("there is no OpenCL platform; ") + kInstallDriver);
    for (unsigned i = 0; i < platforms.size(); ++i) list_platform(platforms[i], i, found, warn);

    if (!cache_warning.empty() && std::any_of(found.begin(), found.end(), [](const DeviceInfo& d) { return d.pocl; }))
        warn(std::exchange(cache_warning, {}));
    if (warnings && found.empty())
        for (DeviceWarning& warning : *warnings) warning.is_minor = false;

    // Some drivers do not know their clock (virtual machines), but still report compute units.
    const auto rank = [](const DeviceInfo& d) {
        return std::make_tuple(d.gpu ? 2 : d.cpu ? 1 : 0, uint64_t(d.compute_units) * std::max(1u, d.clock_mhz));
    };
    std::stable_sort(found.begin(), found.end(), [&](const DeviceInfo& a, const DeviceInfo& b) { return rank(a) > rank(b); });
    return found;
}

void log_warnings(const std::vector<DeviceWarning>& warnings) {
    for (const DeviceWarning& warning : warnings) log(warning.is_minor ? LogLevel::debug : LogLevel::warning, warning.text);
}

std::vector<pid_t> thread_ids() {
    std::vector<pid_t> ids;
    std::error_code error;
    for (std::filesystem::directory_iterator at("/proc/self/task", error), end; !error && at != end; at.increment(error))
        ids.push_back(static_cast<pid_t>(std::atol(at->path().filename().c_str())));
    std::sort(ids.begin(), ids.end());
    return ids;
}

void pin_threads_since(const std::vector<pid_t>& before, size_t expected) {
    cpu_set_t allowed;
    if (std::getenv("POCL_AFFINITY") || sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
    std::vector<size_t> cores;
    for (size_t core = 0; core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &allowed)) cores.push_back(core);
    const std::vector<pid_t> now = thread_ids();
    std::vector<pid_t> started;
    std::set_difference(now.begin(), now.end(), before.begin(), before.end(), std::back_inserter(started));
    if (started.size() != expected) return;
    for (size_t i = 0; i < expected; ++i) {
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(cores[i % cores.size()], &one);
        sched_setaffinity(started[i], sizeof one, &one);  // may be refused, as in a sandbox: the thread then stays free
    }
}

}  // namespace clarity
