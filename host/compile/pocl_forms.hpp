// pocl_forms.hpp -- makes the binaries of PoCL cheap.
//
// PoCL keeps a form of each kernel for each kind of launch in its cache, KERNEL/LOCAL-goffs0-smallgrid/KERNEL.so. When it is
// asked for a binary it also compiles a form for any local size, KERNEL/0-0-0/KERNEL.so, which takes as long as all that was
// compiled before (PoCL 3.1; Cornell box on an AMD EPYC: 12.5 s instead of 6.9 s). No launch of ours uses that form: all our
// kernels have one local size. A second name of the launched form stands in for it.
#pragma once
#include <string>
#include <vector>

namespace clarity {

// Names the launched forms of a program a second time, in the folder pocl_cache(). kernels: all those of the program, launched
// once before. Where PoCL keeps its forms otherwise nothing happens, and PoCL compiles. Throws nothing.
void share_launched_forms(const std::vector<std::string>& kernels);

}  // namespace clarity
