#include "picture/denoiser.hpp"

#include <utility>

#include "device/cl_errors.hpp"
#include "device/kernel_files.hpp"
#include "device/set_arguments.hpp"
#include "picture/film.hpp"

namespace clarity {
namespace {

constexpr int kLevels = 5;  // the last one reaches 2 * 16 pixels to each side
constexpr size_t kLocalSize = 64;

}  // namespace

CompileRequest denoiser_program() {
    return {kernel_text("rt_shared.h") + kernel_text("rt_types.h") + "#line 1 \"cl/denoise.cl\"\n" + kernel_text("denoise.cl"),
            "-cl-std=CL1.2", "denoiser"};
}

Denoiser::Denoiser(std::shared_ptr<Device> device) : device_(std::move(device)) {
    Progress never_cancelled;
    const BuildResult built = compile_program(*device_, denoiser_program(), never_cancelled);
    wrap_cl_errors(*device_, "preparing the denoiser", [&] {
        program_ = built.program;
        split_ = cl::Kernel(program_, "split_light");
        smooth_ = cl::Kernel(program_, "smooth_variances");
        level_ = cl::Kernel(program_, "filter_level");
        join_ = cl::Kernel(program_, "join_light");
    });
}

cl::Event Denoiser::enqueue(const cl::Kernel& kernel, size_t pixels) {
    cl::Event done;
    const size_t items = (pixels + kLocalSize - 1) / kLocalSize * kLocalSize;
    device_->queue().enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(kLocalSize), nullptr, &done);
    return done;
}

const cl::Buffer& Denoiser::run(const cl::Buffer& film, unsigned width, unsigned height, cl::Event& first, cl::Event& last) {
    const size_t pixels = size_t(width) * height, bytes = FilmKernels::room(pixels) * sizeof(cl_float4);
    const cl::Buffer& guides = guides_.fit(device_->context(), bytes);
    const cl::Buffer* from = &light_[0].fit(device_->context(), bytes);
    const cl::Buffer* to = &light_[1].fit(device_->context(), bytes);
    const auto of_picture = cl_uint(pixels);
    const auto columns = cl_int(width), rows = cl_int(height);
    set_arguments(split_, film, of_picture, *from, guides);
    first = enqueue(split_, pixels);
    set_arguments(smooth_, *from, guides, columns, rows, *to);
    enqueue(smooth_, pixels);
    for (int level = 0; level < kLevels; ++level) {
        std::swap(from, to);
        set_arguments(level_, *from, guides, columns, rows, cl_int(1 << level), *to);
        enqueue(level_, pixels);
    }
    set_arguments(join_, film, of_picture, *to, *from);
    last = enqueue(join_, pixels);
    return *from;
}

}  // namespace clarity
