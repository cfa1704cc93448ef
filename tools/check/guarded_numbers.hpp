// guarded_numbers.hpp -- numbers of a plugin's keys as kernels get them, between guards that a read beyond them hits.
#pragma once
#include <memory>

#include "device/device.hpp"
#include "worker/guarded_memory.hpp"

namespace clarity::check {

// Numbers that kernels read, between guards, at least four of them.
std::shared_ptr<const GuardedBytes> guarded_numbers(const float* numbers, size_t count, const char* name);
// The buffer of these bytes. A CPU reads the guarded memory itself, so the bytes must outlive it.
cl::Buffer guarded_buffer(Device& device, const GuardedBytes& bytes);

}  // namespace clarity::check
