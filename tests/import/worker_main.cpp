#include "import/import.hpp"

int main(int argc, char** argv) {
    return clarity::import::import_worker_main(argc, argv);
}
