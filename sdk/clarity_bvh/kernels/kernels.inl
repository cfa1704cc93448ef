// kernels.inl -- includes all kernels in the order of their dependencies. Each kernels*.cpp includes it once, for its
// instruction set.
#include "clarity_bvh/kernels/box8.inl"
#include "clarity_bvh/kernels/binning.inl"
#include "clarity_bvh/kernels/small_range.inl"
#include "clarity_bvh/kernels/subtree.inl"
