// check_job.hpp -- what a worker that runs checks of one phase takes. It returns nothing: each result is reported when it is
// known, because a later check may end the worker.
#pragma once
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/files/parcel.hpp"
#include "import/wire.hpp"
#include "structures/accel_build.hpp"
#include "tools/check/steps.hpp"
#include "worker/job.hpp"

namespace clarity::check {

struct CheckJob {
    std::string library, phase;  // builds, hits, keys, shape, accesses, surface or imports
    std::string device, report, truth, scratch, rays;
    std::vector<std::string> beside, samples, only;
    std::set<std::string> done;  // checks that an earlier worker ran
    std::vector<int> lanes;
    bool quick = false, large = false, list = false, stop_at_first = false;
    uint64_t seed = 0;
    std::vector<import::SentScene> scene;  // to `rays`; none or one
    std::vector<ClosedBuilder> closed;     // instead of `library`: one that only workers of its own open; none or one
    CLARITY_MEMBERS(library, phase, device, report, truth, scratch, rays, beside, samples, only, done, lanes, quick, large,
                    list, stop_at_first, seed, scene, closed);
};

struct CheckResult {
    std::string plugin, name, tried;
    Outcome outcome;
    double seconds = 0;
};

extern const worker::JobKind kCheckJob;
// The work of kCheckJob. Its steps are the name of a check, what it tries, the number of Asked and what it does
// now, each on a line of its own.
void check_job(ParcelReader& arguments);

}  // namespace clarity::check
