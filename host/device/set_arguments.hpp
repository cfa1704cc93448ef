// set_arguments.hpp -- a kernel's arguments in their order, where a program's kernels are few and known.
#pragma once
#include <CL/opencl.hpp>

namespace clarity {

template <class... Arguments>
void set_arguments(cl::Kernel& kernel, const Arguments&... arguments) {
    cl_uint index = 0;
    (kernel.setArg(index++, arguments), ...);
}

}  // namespace clarity
