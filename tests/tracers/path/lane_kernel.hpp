// lane_kernel.hpp -- runs parts of cl/ by themselves: a kernel that reads and writes rows of floats, one row a lane.
#pragma once
#include <CL/opencl.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "device/kernel_files.hpp"
#include "device/program.hpp"

namespace clarity::test {

// A body of OpenCL C that computes an array of vfloat `out[writes]` from `in[reads]`, for any number of lanes. All rows are
// `given`.
class LaneKernel {
 public:
    // parts: files of cl/, and text, which has an end of a line.
    LaneKernel(const std::vector<std::string>& parts, unsigned reads, unsigned writes, const std::string& body, unsigned lanes)
        : reads_(reads), writes_(writes), lanes_(lanes) {
        std::string text =
            "#define RT_LANES " + std::to_string(lanes) + "\n#define RT_CPU " + std::to_string(int(device().info().cpu)) + "\n";
        for (const std::string& part : parts)
            text += part.find('\n') != std::string::npos ? part : "#line 1 \"cl/" + part + "\"\n" + kernel_text(part) + "\n";
        text +=
            "#line 1 \"test\"\n#define READS " + std::to_string(reads) + "u\n#define WRITES " + std::to_string(writes) + "u\n";
        text +=
            "kernel void rows(const global float *given, global float *result) {\n"
            "    const size_t first = get_global_id(0) * RT_LANES;\n    vfloat in[READS], out[WRITES];\n"
            "    for (uint k = 0; k < READS; ++k) {\n        float lane[RT_LANES];\n"
            "        for (uint l = 0; l < RT_LANES; ++l) lane[l] = given[(first + l) * READS + k];\n"
            "        in[k] = rt_load(lane);\n    }\n    {\n" +
            body +
            "\n    }\n    for (uint k = 0; k < WRITES; ++k) {\n        float lane[RT_LANES];\n        rt_store(out[k], lane);\n"
            "        for (uint l = 0; l < RT_LANES; ++l) result[(first + l) * WRITES + k] = lane[l];\n    }\n}\n";
        kernel_ = cl::Kernel(build_program(device(), text, "-cl-std=CL1.2", "a test's rows").program, "rows");
    }

    // rows: `reads` floats each. Returns `writes` floats a row.
    std::vector<float> run(std::vector<float> rows) {
        const size_t count = rows.size() / reads_, group = lanes_ * 8, padded = (count + group - 1) / group * group;
        rows.resize(padded * reads_, 0.5f);
        std::vector<float> found(padded * writes_);
        const cl::Buffer in(device().context(), CL_MEM_READ_ONLY, rows.size() * 4),
            out(device().context(), CL_MEM_WRITE_ONLY, found.size() * 4);
        Queue& queue = device().queue();
        queue.enqueueWriteBuffer(in, CL_TRUE, 0, rows.size() * 4, rows.data());
        kernel_.setArg(0, in);
        kernel_.setArg(1, out);
        queue.enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange(padded / lanes_), cl::NDRange(8));
        queue.enqueueReadBuffer(out, CL_TRUE, 0, found.size() * 4, found.data());
        found.resize(count * writes_);
        return found;
    }

    static Device& device() {
        static Device* const opened = new Device(choose_device(""));  // never destroyed: a driver may be unloaded before
        return *opened;
    }

 private:
    const unsigned reads_, writes_, lanes_;
    cl::Kernel kernel_;
};

// IEC 61966-2-1.
inline double srgb_to_linear(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

}  // namespace clarity::test
