// denoiser.hpp -- filters the noise out of a film of `path` on its device: cl/denoise.cl.
#pragma once
#include <memory>

#include "compile/compile.hpp"
#include "device/device.hpp"
#include "device/growing_buffer.hpp"

namespace clarity {

// The program of these kernels, for compile_ahead().
CompileRequest denoiser_program();

// Owns the kernels and their buffers on one device. Used from one thread; run() may throw cl::Error.
class Denoiser {
 public:
    // Throws Error(kernel_build_failed).
    explicit Denoiser(std::shared_ptr<Device> device);
    // Enqueues the filter. film: RT_FILM_PLANES planes of the whole picture. `first` and `last` become the events of its
    // first and last command. Returns a film of colours, of one sample, which is overwritten by the next call.
    const cl::Buffer& run(const cl::Buffer& film, unsigned width, unsigned height, cl::Event& first, cl::Event& last);

 private:
    cl::Event enqueue(const cl::Kernel& kernel, size_t pixels);

    std::shared_ptr<Device> device_;
    cl::Program program_;
    cl::Kernel split_, smooth_, level_, join_;
    GrowingBuffer guides_{CL_MEM_READ_WRITE}, light_[2]{GrowingBuffer(CL_MEM_READ_WRITE), GrowingBuffer(CL_MEM_READ_WRITE)};
};

}  // namespace clarity
