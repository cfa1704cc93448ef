// mpi_ranks.hpp -- the processes that mpirun has started, as ranks of one picture.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "device/device.hpp"
#include "mpi/mpi_module.h"
#include "render/multi/ranks.hpp"
#include "scene/scene.hpp"

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
    void collect(const std::string& mine, const std::function<void(unsigned, const std::string&)>& take) override;

    // Those of the devices that this rank uses: the ranks of a host share them out. With more ranks than devices, several use
    // the same.
    std::vector<DeviceInfo> own(const std::vector<DeviceInfo>& devices) const;
    // Rank 0 imports, and all get the scene. Throws what import() throws, on rank 0.
    Scene share_scene(const std::function<Scene()>& import);

 private:
    void check(const char* why, const char* what) const;

    const clarity_mpi_module* module_ = nullptr;
    unsigned rank_ = 0, count_ = 1, here_ = 0, here_count_ = 1;
};

}  // namespace clarity
