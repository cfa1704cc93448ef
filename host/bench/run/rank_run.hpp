// rank_run.hpp -- one picture by processes that mpirun starts: `mpirun -n 4 clarity render ... --mpi`.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/files/temporary_folder.hpp"
#include "base/progress.hpp"

namespace clarity::bench {

struct RankRun {
    double whole_ms = 0;   // from the start of mpirun until it has ended
    nlohmann::json stats;  // what `clarity render --stats` wrote
    std::string picture;   // digest of the picture's file
};

// Runs a command that ends in the words of `clarity render`, and waits. folder: takes statistics, picture and messages; the
// command gets their options. install: what to do if the program cannot be started. Throws Error(failed) with the program's
// last words if it fails, and Cancelled, after it has ended with all that it has started.
RankRun run_render(std::vector<std::string> words, const std::string& folder, const std::string& install,
                   const Progress& progress);

// Used from one thread.
class RankRunner {
 public:
    // mpirun: a program and its options, separated by blanks. render: the words after `clarity render`, without those for
    // device, output and statistics. The ranks run this program's own file. Throws Error(failed) without room for a folder.
    RankRunner(const std::string& mpirun, std::vector<std::string> render);
    // Waits for the picture. device: as `--device` takes it; the ranks share those devices out. Throws Error(failed) with the
    // last words of mpirun if it cannot be started or fails, and Cancelled, after all ranks have ended.
    RankRun run(unsigned ranks, const std::string& device, const Progress& progress) const;

 private:
    const TemporaryFolder folder_;
    std::vector<std::string> mpirun_, render_;
};

}  // namespace clarity::bench
