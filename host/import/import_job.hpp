// import_job.hpp -- what an import in a worker takes. It returns a SentScene (wire.hpp).
#pragma once
#include <string>
#include <vector>

#include "base/files/parcel.hpp"
#include "worker/sandbox.hpp"

namespace clarity::import {

struct ImportJob {
    worker::WorkerLimits limits;
    std::vector<std::string> plugins, search_paths, importers, files;
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        parcel(self.limits, self.plugins, self.search_paths, self.importers, self.files);
    }
};

// The work of kImportJob. Its steps are a file, a line break and the importer that reads it, and it waits with each for
// MessageKind::proceed.
void import_job(ParcelReader& arguments);

}  // namespace clarity::import
