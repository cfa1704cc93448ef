// import_job.hpp -- what an import in a worker takes. It returns a SentScene (wire.hpp).
#pragma once
#include <string>
#include <vector>

#include "base/files/packet.hpp"
#include "worker/sandbox.hpp"

namespace clarity::import {

struct ImportJob {
    worker::WorkerLimits limits;
    std::vector<std::string> plugins, search_paths, importers, files;
    template <class Packet, class Self>
    static void visit(Packet& packet, Self& self) {
        packet(self.limits, self.plugins, self.search_paths, self.importers, self.files);
    }
};

// The work of kImportJob. Its steps are a file, a line break and the importer that reads it, and it waits with each for
// MessageKind::proceed.
void import_job(PacketReader& arguments);

}  // namespace clarity::import
