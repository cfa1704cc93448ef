// kernels.inl -- all kernels, in the order in which they need each other. Included once an instruction set, by kernels*.cpp.
#include "box8.inl"
#include "binning.inl"
#include "small_range.inl"
#include "subtree.inl"
