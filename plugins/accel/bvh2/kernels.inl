// kernels.inl -- includes all kernels in the order of their dependencies. Each kernels*.cpp includes it once, for its
// instruction set.
#include "box8.inl"
#include "binning.inl"
#include "small_range.inl"
#include "subtree.inl"
