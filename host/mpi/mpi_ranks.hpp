// mpi_ranks.hpp -- the processes that mpirun has started, as ranks of one picture.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/files/memory_file.hpp"
#include "base/progress.hpp"
#include "device/device.hpp"
#include "mpi/mpi_module.h"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"
#include "stand/ranks.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

// Used from one thread.
class MpiRanks : public Ranks {
 public:
    // Loads the library that knows MPI, and begins. Throws Error(usage) if this program was built without it, and Error(failed)
    // if MPI fails.
    MpiRanks();
    // Ends MPI. Without it, as after an exception, mpirun ends the other ranks when this process ends.
    void finish();

    unsigned rank() const override { return rank_; }
    unsigned count() const override { return count_; }
    std::vector<double> gather(double mine) override;
    void send(const void* data, uint64_t bytes) override;
    void receive(unsigned from, void* data, uint64_t bytes) override;

    // Those of the devices that this rank uses: the ranks of a host share them out. With more ranks than devices, several use
    // the same.
    std::vector<DeviceInfo> own(const std::vector<DeviceInfo>& devices) const;
    // Rank 0 imports, and all get the scene. The ranks of a host have its large arrays in memory once, if one can open files in
    // memory of the other. Throws what import() throws, on rank 0; Error(failed); Cancelled.
    Scene share_scene(const PluginRegistry& plugins, const std::function<Scene()>& import, Progress& progress);
    // The first rank of each host builds, and all of that host get the structure, which is in memory once. nullptr: this rank
    // has to build its own. Throws what build() throws, on the rank that builds; Error(failed); Cancelled.
    std::shared_ptr<const AccelData> share_structure(const PluginRegistry& plugins, const AccelBuilder& build,
                                                     const Scene& scene, Progress& progress);

 private:
    void check(const char* why, const char* what) const;
    MemoryFile file_of_host(bool& mine);

    const clarity_mpi_module* module_ = nullptr;
    unsigned rank_ = 0, count_ = 1, here_ = 0, here_count_ = 1;
    int64_t first_of_host_ = 0;  // the process of this host's first rank
};

}  // namespace clarity
