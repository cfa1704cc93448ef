#include "picture/pinned_memory_pool.hpp"

#include <mutex>
#include <utility>
#include <vector>

#include "base/aligned_bytes.hpp"

#include "device/launch_limit.hpp"

namespace clarity {
namespace {

// Blocks return one by one as newer pictures are displayed. If more are free, they are left over from an earlier use.
constexpr size_t kShelved = 2;

}  // namespace

struct PinnedMemoryPool::Block {
    AlignedBytes plain;
    cl::Buffer pinned;  // used instead of `plain` on devices other than CPUs
    std::shared_ptr<Device> device;
    uint8_t* bytes = nullptr;
    size_t room = 0;
    Block() = default;
    Block(const Block&) = delete;
    Block& operator=(const Block&) = delete;
    ~Block() {
        if (!pinned() || !bytes) return;
        if (device->loss()->stuck()) {
            never_release(std::make_shared<cl::Buffer>(pinned));
            return;
        }
        try {
            device->queue().enqueueUnmapMemObject(pinned, bytes);
        } catch (const cl::Error&) {  // the device is lost, and this memory with it
        }
    }
};

struct PinnedMemoryPool::Shelf {
    std::mutex mutex;
    std::vector<std::unique_ptr<Block>> blocks;
};

PinnedMemoryPool::PinnedMemoryPool(std::shared_ptr<Device> device)
    : device_(std::move(device)), shelf_(std::make_shared<Shelf>()) {}

std::unique_ptr<PinnedMemoryPool::Block> PinnedMemoryPool::make(size_t bytes) {
    auto block = std::make_unique<Block>();
    block->room = bytes;
    if (!device_ || device_->info().cpu) {
        block->plain = AlignedBytes(bytes, false);
        block->bytes = static_cast<uint8_t*>(block->plain.data());
    } else {
        block->device = device_;
        block->pinned = cl::Buffer(device_->context(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
        cl::Event mapped;
        block->bytes = static_cast<uint8_t*>(
            device_->queue().enqueueMapBuffer(block->pinned, CL_FALSE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes, nullptr, &mapped));
        device_->queue().flush();
        wait_for(*device_, mapped, "a launch before the first read-back");
    }
    return block;
}

std::shared_ptr<uint8_t> PinnedMemoryPool::lend(size_t bytes) {
    std::unique_ptr<Block> block;
    {
        const std::lock_guard<std::mutex> lock(shelf_->mutex);
        auto& blocks = shelf_->blocks;
        if (blocks.size() > kShelved) blocks.resize(kShelved);
        if (!blocks.empty() && blocks.back()->room < bytes) blocks.clear();  // the others are too small as well
        if (!blocks.empty()) {
            block = std::move(blocks.back());
            blocks.pop_back();
        }
    }
    if (!block) block = make(bytes);
    Block* const lent = block.release();
    return {lent->bytes, [lent, shelf = shelf_](uint8_t*) {
                std::unique_ptr<Block> back(lent);
                const std::lock_guard<std::mutex> lock(shelf->mutex);
                shelf->blocks.push_back(std::move(back));
            }};
}

}  // namespace clarity
