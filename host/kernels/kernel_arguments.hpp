// kernel_arguments.hpp -- a kernel whose arguments are set by their names.
#pragma once
#include <CL/opencl.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace clarity {

// Macros in declarations of kernels, and the names of the arguments that each stands for, separated by commas.
using ArgumentMacros = std::vector<std::pair<std::string, std::string>>;

// The names of a kernel's arguments in their order, from its declaration in `text`. Empty if the text does not declare such a
// kernel.
std::vector<std::string> argument_names(const std::string& text, const std::string& entry, const ArgumentMacros& macros);

// Holds arguments, so that users must not share one.
class KernelArguments {
 public:
    KernelArguments() = default;
    // where: for messages, the kernel and its file.
    KernelArguments(cl::Kernel kernel, std::vector<std::string> names, std::string where)
        : kernel_(std::move(kernel)), names_(std::move(names)), numbers_(names_.size()), where_(std::move(where)) {}
    bool has(std::string_view name) const;
    // Throws Error(kernel_build_failed) if the kernel has no argument of that name, as after an edit; and cl::Error.
    template <class T>
    KernelArguments& set(std::string_view name, const T& value) {
        const cl_uint number = number_of(name);
        if constexpr (std::is_same_v<T, cl_uint>) {
            if (numbers_[number] == value) return *this;
            kernel_.setArg(number, value);
            numbers_[number] = value;
        } else {
            kernel_.setArg(number, value);
        }
        return *this;
    }
    cl::Kernel& kernel() { return kernel_; }

 private:
    cl_uint number_of(std::string_view name) const;
    cl::Kernel kernel_;
    std::vector<std::string> names_;
    std::vector<std::optional<cl_uint>> numbers_;  // of these names: those that the kernel has
    std::string where_;
};

}  // namespace clarity
