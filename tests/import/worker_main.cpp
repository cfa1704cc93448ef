#include "import/import_in_worker.hpp"
#include "worker/child.hpp"

int main(int argc, char** argv) {
    return clarity::worker::worker_main(clarity::import::kImportJob, argc, argv);
}
